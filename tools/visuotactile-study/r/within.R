# SPDX-License-Identifier: LGPL-2.1-or-later
# The analysis of variance within people, without packages.

# Contrasts of so many levels that are orthogonal and have length 1.
helmert <- function(levels) {
  contrasts <- contr.helmert(levels)
  sweep(contrasts, 2, sqrt(colSums(contrasts^2)), "/")
}

# The p value of an effect, as afex has it (type 3, corrected by Greenhouse and Geisser): from a row of scores on its contrasts for each person,
# and the groups of people, from 1 on.
p_within <- function(scores, group) {
  sizes <- as.vector(table(group))
  middle <- rowsum(scores, group) / sizes
  covariance <- crossprod(scores - middle[group, , drop = FALSE])
  rest <- sum(diag(covariance))
  q <- ncol(scores)
  # Type 3: groups count equally.
  effect <- length(sizes)^2 / sum(1 / sizes) * sum(colMeans(middle)^2)
  df2 <- q * (nrow(scores) - length(sizes))
  epsilon <- rest^2 / (q * sum(covariance^2))
  pf(effect / q / (rest / df2), epsilon * q, epsilon * df2, lower.tail = FALSE)
}
