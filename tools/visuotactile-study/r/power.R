# SPDX-License-Identifier: LGPL-2.1-or-later
# How many people a study needs: simulated studies of each size, analyzed as afex does (type 3, corrected by Greenhouse and Geisser), without packages.
# Usage: Rscript power.R EFFECT SPREAD CORRELATION POWER STUDIES SEED FACTOR:LEVELS:within|between:effect|none...

options(error = quote(quit(status = 1))) # the last line is the error
source(file.path(dirname(sub("^--file=", "", grep("^--file=", commandArgs(), value = TRUE)[1])), "within.R"))
arguments <- commandArgs(trailingOnly = TRUE)
effect <- as.numeric(arguments[1])
spread <- as.numeric(arguments[2])
correlation <- as.numeric(arguments[3])
wanted <- as.numeric(arguments[4])
studies <- as.integer(arguments[5])
set.seed(as.integer(arguments[6]))
factors <- do.call(rbind, strsplit(arguments[-(1:6)], ":"))
levels <- as.integer(factors[, 2])
is_between <- factors[, 3] == "between"
of_effect <- factors[, 4] == "effect"
within_levels <- levels[!is_between]
cells <- prod(within_levels)
groups <- prod(levels[is_between])
size <- levels[of_effect]

# The effect grows evenly from the first level to the last.
means <- seq(-0.5, 0.5, length.out = size) * effect
# The contrasts of the factor, times the mean of all other factors.
contrast <- matrix(1)
for (i in which(!is_between)) {
  own <- if (of_effect[i]) helmert(levels[i]) else matrix(1 / sqrt(levels[i]), nrow = levels[i])
  contrast <- kronecker(contrast, own)
}
level_of_cell <- rep(1, cells)
if (any(of_effect & !is_between)) {
  grid <- do.call(expand.grid, rev(lapply(within_levels, seq_len)))
  level_of_cell <- rev(as.list(grid))[[which(which(!is_between) == which(of_effect))]]
}

p_of_study <- function(people) {
  group <- rep(seq_len(groups), length.out = people)
  noise <- matrix(rnorm(people * cells, sd = spread * sqrt(1 - correlation)), people) + rnorm(people, sd = spread * sqrt(correlation))
  if (is_between[of_effect]) {
    # Groups of other factors between are pooled: the effect has the groups' means.
    grid <- do.call(expand.grid, rev(lapply(levels[is_between], seq_len)))
    level <- rev(as.list(grid))[[which(which(is_between) == which(of_effect))]][group]
    y <- rowMeans(noise) + means[level]
    cell <- factor(group)
    full <- lm.fit(model.matrix(~ cell), y)
    # Sum of squares of the factor among the groups' means, type 3.
    design <- model.matrix(~ C(factor(level), contr.sum))
    rest <- sum(full$residuals^2) / (people - groups)
    between <- sum((lm.fit(design, y)$fitted.values - mean(y))^2) / (size - 1)
    return(pf(between / rest, size - 1, people - groups, lower.tail = FALSE))
  }
  y <- noise + matrix(means[level_of_cell], people, cells, byrow = TRUE)
  p_within(y %*% contrast, group)
}
known <- list() # by people: each is simulated and printed once
power_of <- function(people) {
  name <- as.character(people)
  if (is.null(known[[name]])) {
    known[[name]] <<- mean(replicate(studies, p_of_study(people)) < 0.05)
    cat(sprintf("%4d people: power %.3f\n", people, known[[name]]))
  }
  known[[name]]
}

step <- max(groups, 1)
people <- max(2 * groups, 4)
people <- ceiling(people / step) * step
most <- 400
cat(sprintf("An effect of %g points on %s (ratings with a standard deviation of %g, correlation %g), %d studies each:\n", effect, factors[of_effect, 1], spread, correlation, studies))
repeat {
  power <- power_of(people)
  if (power >= wanted || people >= most)
    break
  people <- ceiling(max(people + 1, people * (if (power < wanted / 2) 1.5 else 1.1)) / step) * step
}
if (power < wanted) {
  cat(sprintf("more than %d people are needed\n", most))
} else {
  # Back to the smallest that suffices.
  while (people - step >= max(2 * groups, 3) && power_of(people - step) >= wanted)
    people <- people - step
  row <- if (cells %% 2 == 0 || cells == 1) cells else 2 * cells
  whole <- ceiling(people / (row * groups)) * row * groups
  cat(sprintf("needed: %d people; with complete squares of orders: %d\n", people, whole))
}
