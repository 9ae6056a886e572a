# SPDX-License-Identifier: LGPL-2.1-or-later
# The analysis of the answers to one question.

needed <- c("afex", "emmeans")
missing <- needed[!vapply(needed, requireNamespace, logical(1), quietly = TRUE)]
if (length(missing) > 0) {
  message("the report needs R packages: install ", paste0("r-cran-", missing, collapse = " "))
  quit(status = 1)
}
suppressMessages({ library(afex); library(emmeans) })
afex_options(type = 3, correction_aov = "GG", es_aov = "ges", include_aov = FALSE)

# Means and standard errors over people, in each combination of levels.
means_of <- function(data, factors) {
  groups <- if (length(factors)) split(data, data[factors], drop = TRUE) else list(data)
  rows <- lapply(groups, function(cell) {
    of_person <- tapply(cell$value, cell$participant, mean)
    cbind(cell[1, factors, drop = FALSE], n = length(of_person), mean = mean(of_person), se = sd(of_person) / sqrt(length(of_person)))
  })
  do.call(rbind, c(rows, make.row.names = FALSE))
}

# One question: the analysis of variance, its comparisons, or why there is none. The data have the columns participant and value, and a
# factor of each name.
analyze <- function(question, data, within_all, between_all, compare = TRUE) {
  varies <- function(name) length(unique(data[[name]])) > 1
  within <- Filter(varies, within_all)
  between <- Filter(varies, between_all)
  result <- list(question = question, means = cbind(question = question, means_of(data, c(within_all, between_all))))
  for (name in c(within, between))
    data[[name]] <- droplevels(data[[name]])
  if (length(within) + length(between) == 0)
    return(c(result, why = "it was answered under one condition"))
  if (sd(data$value) == 0)
    return(c(result, why = "all answers are equal"))
  model <- tryCatch(
    suppressWarnings(suppressMessages(aov_ez("participant", "value", data, within = if (length(within)) within, between = if (length(between)) between))),
    error = function(e) conditionMessage(e))
  if (is.character(model))
    return(c(result, why = model))
  table <- as.data.frame(suppressWarnings(anova(model, es = "ges", correction = "GG")))
  # Those who answered under each condition: others are not in the model.
  cells <- table(data$participant, if (length(within)) interaction(data[within], drop = TRUE) else rep(1, nrow(data)))
  n <- sum(rowSums(cells > 0) == ncol(cells))
  # The correction leaves the ratio of the degrees of freedom, and so the partial eta squared.
  result$anova <- data.frame(question = question, effect = rownames(table), n = n, df1 = table[["num Df"]], df2 = table[["den Df"]], F = table[["F"]],
                             p = table[["Pr(>F)"]], ges = table[["ges"]], pes = table[["F"]] * table[["num Df"]] / (table[["F"]] * table[["num Df"]] + table[["den Df"]]))
  comparisons <- lapply(if (compare) c(within, between), function(name) {
    if (nlevels(data[[name]]) < 3)
      return(NULL)
    pairs <- as.data.frame(summary(suppressMessages(pairs(emmeans(model, name, model = "multivariate"), adjust = "holm"))))
    data.frame(question = question, factor = name, contrast = as.character(pairs$contrast), difference = pairs$estimate, se = pairs$SE,
               t = pairs$t.ratio, df = pairs$df, p = pairs$p.value)
  })
  result$comparisons <- do.call(rbind, comparisons)
  result
}
