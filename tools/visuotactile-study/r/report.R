# SPDX-License-Identifier: LGPL-2.1-or-later
# The report of a study: answers.csv, orders.csv and dictionary.tsv of a folder -> report.html, report.pdf, figure.png, anova.csv, means.csv.
# Usage: Rscript report.R FOLDER PUBLISHED.csv with-marked|without-marked

options(error = quote(quit(status = 1))) # the last line is the error
source(file.path(dirname(sub("^--file=", "", grep("^--file=", commandArgs(), value = TRUE)[1])), "analysis.R"))

arguments <- commandArgs(trailingOnly = TRUE)
folder <- arguments[1]
published_file <- arguments[2]
with_marked <- arguments[3] == "with-marked"
path <- function(name) file.path(folder, name)

# Of the researcher alone, as the answers are; nothing of an earlier report stays.
Sys.umask("077")
invisible(file.remove(list.files(folder, "^(anova\\.csv|means\\.csv|report\\.(html|pdf)|figure(-[0-9]+)?\\.png)$", full.names = TRUE)))

dictionary <- read.delim(path("dictionary.tsv"), quote = "", colClasses = "character", na.strings = character())
entries <- function(what) dictionary[dictionary$what == what, ]
label_of <- function(what, name, of = "") {
  found <- dictionary$label[dictionary$what == what & dictionary$name == name & (of == "" | dictionary$of == of)]
  if (length(found) > 0) found[1] else name
}
title <- entries("title")$label
values <- entries("values")$label
within_all <- entries("within")$name
between_all <- entries("between")$name

answers <- read.csv(path("answers.csv"), colClasses = "character", check.names = FALSE, na.strings = character())
done <- answers[answers$state == "done", ]
sessions <- done[!(done$session %in% c("practice", "end")), ]
ratings <- sessions[sessions$kind != "text", ]
ratings$value <- as.numeric(ratings$answer)
for (name in c(within_all, between_all)) {
  gone <- if (is.null(ratings[[name]])) rep(TRUE, nrow(ratings)) else !(ratings[[name]] %in% dictionary$name[dictionary$what == "level" & dictionary$of == name])
  if (any(gone)) {
    message("expected levels of '", name, "' that study.ini has, got '", paste(unique(ratings[[name]][gone]), collapse = "', '"), "' of ", paste(unique(ratings$participant[gone]), collapse = " "),
            ", who began with another study.ini; put that one back")
    quit(status = 1)
  }
  ratings[[name]] <- factor(ratings[[name]], levels = dictionary$name[dictionary$what == "level" & dictionary$of == name])
}
marked <- unique(sessions[sessions$marks != "", c("participant", "session", "marks")])
used <- if (with_marked) ratings else ratings[!(ratings$participant %in% marked$participant), ]
people <- length(unique(used$participant))
if (people < 2) {
  message("expected two or more people who finished without marked sessions, got ", people, "; see visuotactile-study status")
  quit(status = 1)
}
# In the order of the study.
questions <- intersect(entries("question")$name, unique(used$question))
gone <- setdiff(unique(used$question), questions)

p_text <- function(p) ifelse(is.na(p), "", ifelse(p < 0.001, "< .001", sub("^0", "", sprintf("%.3f", p))))
number <- function(x, digits = 2) ifelse(is.na(x), "", formatC(x, digits = digits, format = "f"))

results <- lapply(questions, function(question) analyze(question, used[used$question == question, ], within_all, between_all))
bind <- function(part) do.call(rbind, lapply(results, `[[`, part))
anovas <- bind("anova")
means <- bind("means")
comparisons <- bind("comparisons")
if (!is.null(anovas)) write.csv(anovas, path("anova.csv"), row.names = FALSE)
write.csv(means, path("means.csv"), row.names = FALSE)

# A panel for each question, a group of bars for each level of the last factor, as in Fig. 7 of the paper.
# Twelve panels a page.
pages <- split(questions, (seq_along(questions) - 1) %/% 12)
shades <- c("#c3cad3", "#27507d", "#e08a1e", "#5a9a68", "#8a5a9a", "#444444")
draw <- function(questions) {
  columns <- min(3, length(questions))
  par(mfrow = c(ceiling(length(questions) / columns), columns), mar = c(3.6, 3.6, 2.4, 0.6), mgp = c(2.4, 0.9, 0), las = 1, cex = 0.8)
  factors <- c(within_all, between_all)
  along <- if (length(factors) > 0) factors[length(factors)] else NULL
  for (question in questions) {
    cells <- means[means$question == question, ]
    others <- setdiff(factors, along)
    cells$bar <- if (length(others)) do.call(paste, c(lapply(others, function(name) vapply(as.character(cells[[name]]), function(level) label_of("level", level, name), "")), sep = ", ")) else ""
    bars <- unique(cells$bar)
    groups <- if (is.null(along)) "" else levels(droplevels(cells[[along]]))
    pick <- function(what) sapply(groups, function(group) sapply(bars, function(bar) {
      found <- cells[[what]][cells$bar == bar & (if (is.null(along)) TRUE else cells[[along]] == group)]
      if (length(found)) found[1] else NA
    }))
    height <- matrix(pick("mean"), nrow = length(bars))
    error <- matrix(pick("se"), nrow = length(bars))
    names <- vapply(groups, function(group) gsub(" ", "\n", label_of("level", group, if (is.null(along)) "" else along)), "")
    scale <- as.numeric(strsplit(label_of("scale", question), " ")[[1]])
    lower <- min(0, scale[1])
    top <- max(0, scale[2], height + error, na.rm = TRUE)
    all_bars <- unique(vapply(seq_len(nrow(means)), function(i) paste(vapply(others, function(name) label_of("level", as.character(means[[name]][i]), name), ""), collapse = ", "), ""))
    fills <- shades[(match(bars, all_bars) - 1) %% length(shades) + 1]
    at <- barplot(height, beside = TRUE, names.arg = names, ylim = c(lower, lower + (top - lower) * 1.18), col = fills, border = NA, ylab = values, main = question)
    arrows(at, height - error, at, height + error, angle = 90, code = 3, length = 0.03)
    if (any(nzchar(bars)))
      legend("top", legend = bars, fill = fills, border = NA, bty = "n", horiz = TRUE, cex = 0.85)
  }
}
figures <- sprintf("figure%s.png", c("", sprintf("-%d", seq_along(pages)[-1])))
for (i in seq_along(pages)) {
  png(path(figures[i]), width = 9, height = 2.7 * ceiling(length(pages[[i]]) / min(3, length(pages[[i]]))), units = "in", res = 130, type = "cairo")
  draw(pages[[i]])
  invisible(dev.off())
}

anova_table <- function(rows) data.frame(Question = rows$question, Effect = rows$effect, n = rows$n, F = sprintf("F(%s, %s) = %s", sub("\\.00$", "", number(rows$df1)), sub("\\.00$", "", number(rows$df2)), number(rows$F)),
                                         p = p_text(rows$p), "gen. eta2" = number(rows$ges, 3), "part. eta2" = number(rows$pes, 3), check.names = FALSE)
means_table <- data.frame(Question = means$question, means[c(within_all, between_all)], n = means$n, Mean = number(means$mean), SE = number(means$se), check.names = FALSE)

# Published results beside those of this study. An effect is a factor, or FACTOR=LEVEL for a mean.
here <- function(question, effect, statistic) {
  if (grepl("=", effect)) {
    of <- strsplit(effect, "=")[[1]]
    cell <- used[used$question == question & used[[of[1]]] %in% of[2], ]
    if (nrow(cell) == 0) return("")
    of_person <- tapply(cell$value, cell$participant, mean)
    return(sprintf("%s (SE %s)", number(mean(of_person)), number(sd(of_person) / sqrt(length(of_person)))))
  }
  row <- anovas[anovas$question == question & anovas$effect == effect, ]
  if (is.null(row) || nrow(row) == 0) return("")
  sprintf("F(%s, %s) = %s, p %s", sub("\\.00$", "", number(row$df1)), sub("\\.00$", "", number(row$df2)), number(row$F), sub("^\\.", "= .", p_text(row$p)))
}
published <- if (file.exists(published_file)) read.csv(published_file, colClasses = "character") else NULL
beside <- if (!is.null(published))
  data.frame(Question = published$question, Effect = published$effect, Published = trimws(paste(ifelse(published$value == "", "", paste(published$statistic, "=", published$value)), published$note)),
             Here = mapply(here, published$question, published$effect, published$statistic), check.names = FALSE)

timed <- if (with_marked) sessions else sessions[!(sessions$participant %in% marked$participant), ]
timing <- unique(timed[c("participant", "session", "commands", "error_p50_ms", "error_p99_ms", "error_max_ms", "frames", "frames_dropped")])
timing[-(1:2)] <- lapply(timing[-(1:2)], as.numeric)
with_commands <- timing[!is.na(timing$commands) & timing$commands > 0, ]
texts <- answers[answers$state == "done" & answers$kind == "text" & answers$text != "", c("participant", "question", "text")]
versions <- unique(sessions[c("study", "program", "gstreamer", "consent")])
orders <- read.csv(path("orders.csv"), check.names = FALSE, colClasses = "character", na.strings = character())

facts <- c(
  sprintf("%d people are analyzed; %d finished, %d did not.", people, length(unique(done$participant)), sum(!(orders$state %in% "done"))),
  if (nrow(marked) > 0) sprintf("%d sessions are marked (below); %s.", nrow(marked),
    if (with_marked) "they are used" else "people with one are left out"),
  if (nrow(with_commands) > 0) sprintf("Commands of the chair: %d in %d sessions, timing error %s ms (median of sessions), p99 %s ms at most, %s ms at most.",
    sum(with_commands$commands), nrow(with_commands), number(median(with_commands$error_p50_ms)), number(max(with_commands$error_p99_ms)), number(max(with_commands$error_max_ms))),
  if (any(timing$frames > 0, na.rm = TRUE)) sprintf("Frames: %d shown, %d dropped.", sum(timing$frames, na.rm = TRUE), sum(timing$frames_dropped, na.rm = TRUE)),
  if (nrow(unique(done["study"])) > 1) sprintf("study.ini was changed between participants: %s.",
    paste(vapply(unique(done$study), function(one) sprintf("%s with %s", paste(unique(done$participant[done$study == one]), collapse = " "), one), ""), collapse = "; ")),
  if (length(gone)) sprintf("Questions that study.ini no longer has are left out: %s.", paste(gone, collapse = ", ")),
  sprintf("Programs: visuotactile %s, %s; study %s; consent %s.", paste(unique(versions$program), collapse = ", "), paste(unique(versions$gstreamer), collapse = ", "), paste(unique(versions$study), collapse = ", "), paste(unique(versions$consent), collapse = ", ")),
  sprintf("Analysis: %s, afex %s, emmeans %s. Repeated-measures ANOVA, type 3, degrees of freedom by Greenhouse and Geisser; generalized and partial eta squared; comparisons by Holm.", R.version.string, packageVersion("afex"), packageVersion("emmeans")))
unanalyzed <- unlist(lapply(results, function(one) if (!is.null(one$why)) sprintf("%s: %s", one$question, one$why)))

escape <- function(text) { for (pair in list(c("&", "&amp;"), c("<", "&lt;"), c(">", "&gt;"), c("\"", "&quot;"))) text <- gsub(pair[1], pair[2], text, fixed = TRUE); text }
html_table <- function(data) {
  cells <- apply(data, 1, function(row) paste0("<tr>", paste0("<td>", escape(row), "</td>", collapse = ""), "</tr>"))
  paste0("<table><tr>", paste0("<th>", escape(names(data)), "</th>", collapse = ""), "</tr>", paste(cells, collapse = "\n"), "</table>")
}
base64 <- function(bytes) {
  letters64 <- c(LETTERS, letters, 0:9, "+", "/")
  pad <- (3 - length(bytes) %% 3) %% 3
  b <- matrix(c(as.integer(bytes), rep(0L, pad)), nrow = 3)
  codes <- rbind(b[1, ] %/% 4, (b[1, ] %% 4) * 16 + b[2, ] %/% 16, (b[2, ] %% 16) * 4 + b[3, ] %/% 64, b[3, ] %% 64)
  text <- letters64[codes + 1]
  if (pad > 0) text[(length(text) - pad + 1):length(text)] <- "="
  paste(text, collapse = "")
}
images <- vapply(path(figures), function(file) sprintf("<img alt=\"%s by condition\" src=\"data:image/png;base64,%s\">", escape(values), base64(readBin(file, "raw", file.size(file)))), "")
comparison_table <- if (!is.null(comparisons)) data.frame(Question = comparisons$question, Factor = comparisons$factor, Levels = comparisons$contrast, Difference = number(comparisons$difference), SE = number(comparisons$se),
  t = sprintf("t(%s) = %s", sub("\\.00$", "", number(comparisons$df)), number(comparisons$t)), p = p_text(comparisons$p))
tables <- list(
  "Questions" = data.frame(Question = questions, Words = vapply(questions, function(name) label_of("question", name), "")),
  "Published results beside" = beside,
  "Analysis of variance" = if (!is.null(anovas)) anova_table(anovas),
  "Not analyzed" = if (length(unanalyzed)) data.frame(Question = sub(": .*", "", unanalyzed), Why = sub("^[^:]*: ", "", unanalyzed)),
  "Comparisons of levels" = comparison_table, "Means" = means_table, "Marked sessions" = marked, "Orders" = orders,
  "Timing of commands by session, in ms" = timing, "Free answers" = texts)
tables <- Filter(function(table) !is.null(table) && nrow(table) > 0, tables)
writeLines(c(
  "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\">", sprintf("<title>%s</title>", escape(title)),
  "<style>body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}table{border-collapse:collapse;font-size:.9em}th,td{text-align:left;padding:.15rem .9rem .15rem 0;border-bottom:1px solid #ddd}img{max-width:100%}</style>",
  sprintf("<h1>%s</h1>", escape(title)), paste0("<p>", escape(facts), "</p>"),
  "<h2>Means and standard errors</h2>", images,
  unlist(lapply(names(tables), function(name) c(sprintf("<h2>%s</h2>", name), html_table(tables[[name]])))),
  "</html>"), path("report.html"))

# The same on pages.
pdf(path("report.pdf"), width = 8.27, height = 11.69, title = title)
lines_page <- function(heading, lines) {
  size <- 62
  for (start in seq(1, max(1, length(lines)), by = size)) {
    par(mar = c(0, 0, 0, 0), mfrow = c(1, 1))
    plot.new()
    text(0.04, 0.97, heading, adj = c(0, 1), font = 2, cex = 1.1)
    part <- lines[start:min(length(lines), start + size - 1)]
    text(0.04, 0.94 - (seq_along(part) - 1) * 0.0145, part, adj = c(0, 1), family = "mono", cex = 0.62)
  }
}
text_table <- function(data) {
  text <- gsub("[\r\n\t]+", " ", rbind(names(data), as.matrix(data)))
  text[is.na(text)] <- ""
  widths <- apply(nchar(text), 2, max)
  # A line of a page has 120 characters: what is longer goes on in the next one, at a column if there is one.
  parts <- split(seq_along(widths), (cumsum(pmin(widths, 50) + 2) - 1) %/% 110)
  lines <- apply(text, 1, function(row) vapply(parts, function(part) trimws(paste(sprintf("%-*s", widths[part], row[part]), collapse = "  "), "right"), ""))
  unlist(lapply(matrix(lines, nrow = length(parts)), function(line) substring(line, starts <- seq(1, max(1, nchar(line)), by = 120), starts + 119)))
}
lines_page(title, unlist(lapply(facts, function(fact) c(strwrap(fact, 100), ""))))
for (page in pages) {
  par(oma = c(0, 0, 2, 0))
  draw(page)
  mtext("Means and standard errors", outer = TRUE, font = 2)
}
for (name in names(tables)) lines_page(name, text_table(tables[[name]]))
invisible(dev.off())

cat(sprintf("%s people analyzed\n", people))
if (!is.null(anovas)) cat(text_table(anova_table(anovas)), sep = "\n")
if (nrow(marked) > 0 && !with_marked) cat(sprintf("left out, as a session is marked: %s\n", paste(unique(marked$participant), collapse = " ")))
