# SPDX-License-Identifier: LGPL-2.1-or-later
# How often the report's analysis finds an effect in simulated studies of the paper's design (2 x 3 within, ratings from 1 to 100 in whole
# points), and how often it should, by the noncentral F distribution. Prints a row for docs/measured/study.md, as study.sh does.
# Usage: Rscript study_power.R FOLDER_OF_ANALYSIS EFFECT PEOPLE STUDIES SEED...      STUDIES: of each seed

arguments <- commandArgs(trailingOnly = TRUE)
source(file.path(arguments[1], "analysis.R"))
effect <- as.numeric(arguments[2])
people <- as.integer(arguments[3])
studies <- as.integer(arguments[4])
seeds <- as.integer(arguments[-(1:4)])
spread <- 15 # of people, and of answers

cells <- expand.grid(film = c("static", "dynamic", "real"), cues = c("without", "with"), participant = sprintf("P%02d", seq_len(people)))
p_of_study <- function(i) {
  person <- rnorm(people, sd = spread)
  value <- 50.5 + ifelse(cells$cues == "with", 0.5, -0.5) * effect + person[as.integer(cells$participant)] + rnorm(nrow(cells), sd = spread)
  data <- cbind(cells, value = pmin(pmax(round(value), 1), 100))
  anova <- analyze("Q1", data, c("cues", "film"), character(), compare = FALSE)$anova
  setNames(anova$p, anova$effect)
}
p <- do.call(cbind, lapply(seeds, function(seed) {
  set.seed(seed)
  vapply(seq_len(studies), p_of_study, c(cues = 0, film = 0, "cues:film" = 0))
}))
found <- rowMeans(p < 0.05)
nominal <- pf(qf(0.95, 1, people - 1), 1, people - 1, ncp = people * effect^2 / (2 * spread^2 / 3), lower.tail = FALSE)
cat(sprintf("| %g | %d | %d | %.3f | %.3f | %.3f | %.3f |\n", effect, people, ncol(p), nominal, found["cues"], found["film"], found["cues:film"]))
