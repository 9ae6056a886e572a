#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The report of visuotactile-study against an independent computation: two-way within analysis of variance in closed form, Greenhouse and Geisser's
correction, means and standard errors; data made to the paper's figures; marked sessions; power.

Usage: report.py [TEST ...]
"""
import csv
import itertools
import pathlib
import re
import shutil
import subprocess
import sys

import numpy
from scipy import stats
from study_page import change, exported, os, run_study, tempfile

CUES, FILMS = ("without", "with"), ("static", "dynamic", "real")


def new_study(parent, *simulation):
    """The paper's study, as `new` writes it, with simulated people and without films."""
    folder = pathlib.Path(parent) / "study"
    run_study("new", folder, "--length=1", "--side=64")
    run_study("simulate", folder, *simulation)
    return folder


def cells(rows, question):
    """People × cues × films."""
    people = sorted({row["participant"] for row in rows})
    found = {(row["participant"], row["cues"], row["film"]): float(row["answer"]) for row in rows if row["question"] == question and row["session"].isdigit()}
    return numpy.array([[[found.get((person, cue, film), numpy.nan) for film in FILMS] for cue in CUES] for person in people])


def helmert(k):
    """Orthonormal contrasts."""
    columns = []
    for i in range(1, k):
        column = numpy.zeros(k)
        column[:i], column[i] = 1, -i
        columns.append(column / numpy.linalg.norm(column))
    return numpy.array(columns).T


def within(data, contrasts):
    """F, corrected degrees of freedom and p of an effect within: by the scores on its contrasts."""
    scores = data.reshape(len(data), -1) @ contrasts
    n, q = scores.shape
    effect = n * (scores.mean(0) ** 2).sum() / q
    error = ((scores - scores.mean(0)) ** 2).sum() / (q * (n - 1))
    covariance = numpy.atleast_2d(numpy.cov(scores.T))
    epsilon = numpy.trace(covariance) ** 2 / (q * numpy.trace(covariance @ covariance))
    f = effect / error
    return f, epsilon * q, epsilon * q * (n - 1), stats.f.sf(f, epsilon * q, epsilon * q * (n - 1))


def effects(data):
    """All effects of cues × films."""
    of_cues, of_films = helmert(2), helmert(3)
    mean2, mean3 = numpy.ones((2, 1)) / numpy.sqrt(2), numpy.ones((3, 1)) / numpy.sqrt(3)
    return {"cues": within(data, numpy.kron(of_cues, mean3)), "film": within(data, numpy.kron(mean2, of_films)), "cues:film": within(data, numpy.kron(of_cues, of_films))}


def read(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def compare(rows, report):
    """F, degrees of freedom, p, means and errors."""
    anova = {(row["question"], row["effect"]): row for row in read(report / "anova.csv")}
    expected = {}
    for question in ("Q1", "Q2", "Q3", "Q4"):
        expected |= {(question, name): effect for name, effect in effects(cells(rows, question)).items()}
    for question in ("QA", "QB"):
        expected[(question, "film")] = within(cells(rows, question)[:, 1], helmert(3))
    assert anova.keys() == expected.keys(), (anova.keys(), expected.keys())
    for key, numbers in expected.items():
        ours = [float(anova[key][name]) for name in ("F", "df1", "df2", "p")]
        assert numpy.allclose(ours, numbers, rtol=1e-6, atol=1e-12), (key, ours, numbers)
    for row in read(report / "means.csv"):
        data = cells(rows, row["question"])[:, CUES.index(row["cues"]), FILMS.index(row["film"])]
        assert numpy.allclose([float(row["n"]), float(row["mean"]), float(row["se"])], [len(data), data.mean(), data.std(ddof=1) / len(data) ** 0.5], rtol=1e-9), row
    return anova


def the_same_as_in_closed_form(parent):
    folder = new_study(parent, "--effect=12", "--seed=3")
    said = run_study("report", folder)
    assert "12 people analyzed" in said
    compare(exported(folder), folder / "report")
    assert "12 people analyzed" in run_study("report", folder), "its own report is replaced"
    page = (folder / "report/report.html").read_text(encoding="utf-8")
    assert "39.95" in page and "data:image/png;base64,iVBOR" in page and not re.search("(src|href)=\"(?!data:)", page)
    assert (folder / "report/report.pdf").read_bytes().startswith(b"%PDF")


def a_foreign_folder_is_kept(parent):
    """What is of no report of this study is not replaced, also not the report of another study."""
    folder, other = new_study(parent, "--people=2"), pathlib.Path(parent) / "thesis"
    other.mkdir()
    for kept in ({"report.html": "mine"}, {"report.html": "", "dictionary.tsv": "what\tname\tof\tlabel\ntitle\t\t\tAnother study\n"}):
        for name, text in kept.items():
            (other / name).write_text(text)
        answer = subprocess.run([os.environ["STUDY"], "report", folder, f"--output={other}"], capture_output=True, text=True)
        assert {path.name: path.read_text() for path in other.iterdir()} == kept, list(other.iterdir())
        assert answer.returncode == 1 and f"'{other}' has other files" in answer.stderr and "--force" in answer.stderr, answer.stderr


def unknown_factors_are_refused(parent):
    folder = new_study(parent, "--people=2")
    for words in (["power", folder], ["simulate", shutil.copytree(folder, f"{parent}/empty", ignore=shutil.ignore_patterns("data"))]):
        answer = subprocess.run([os.environ["STUDY"], *words, "--factor=color"], capture_output=True, text=True)
        assert answer.returncode == 2 and "expected --factor=NAME, a factor of the study, got 'color'" in answer.stderr, answer.stderr


def standard(shape, generator):
    """Deviations of people with mean 0 and variance 1 in each column, not correlated."""
    q, _ = numpy.linalg.qr(numpy.column_stack([numpy.ones(shape[0]), generator.normal(size=shape)]))
    return q[:, 1:] * (shape[0] - 1) ** 0.5


PAPER_F = {"Q1": 39.95, "Q2": 33.05, "Q3": 30.87, "Q4": 21.79}


def paper_data(generator):
    """Answers of 12 people with the paper's F of cues, no effect of the film (F = 1), and its means and errors of QA."""
    n, data = 12, {}
    for question, f in PAPER_F.items():
        scores = standard((n, 5), generator) * 8
        scores[:, 0] += 8 * (f / n) ** 0.5  # F = n mean² / variance
        scores[:, 1] += 8 * (1 / n) ** 0.5
        scores[:, 2] += 8 * (1 / n) ** 0.5
        mean2, mean3 = numpy.ones((2, 1)) / 2 ** 0.5, numpy.ones((3, 1)) / 3 ** 0.5
        contrasts = numpy.hstack([-numpy.kron(helmert(2), mean3), numpy.kron(mean2, helmert(3)), numpy.kron(helmert(2), helmert(3))])
        data[question] = (60 + generator.normal(0, 5, (n, 1)) + scores @ contrasts.T).reshape(n, 2, 3)
    for question, means, errors in (("QA", (89, 75, 60), (2.68, 4, 5.48)), ("QB", (80, 78, 60), (4, 4, 4))):
        data[question] = numpy.full((n, 2, 3), numpy.nan)
        data[question][:, 1] = numpy.array(means) + standard((n, 3), generator) * numpy.array(errors) * n ** 0.5
    return data


def the_papers_conclusions(parent):
    folder = new_study(parent)
    report = folder / "report"
    run_study("report", folder, f"--output={report}")  # for dictionary and orders
    rows, data = exported(folder), paper_data(numpy.random.default_rng(2012))
    people = sorted({row["participant"] for row in rows})
    for row in rows:
        if row["session"].isdigit():
            row["answer"] = repr(float(data[row["question"]][people.index(row["participant"]), CUES.index(row["cues"]), FILMS.index(row["film"])]))
    with (report / "answers.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, rows[0].keys())
        table.writeheader()
        table.writerows(rows)
    subprocess.run(["Rscript", "--vanilla", os.environ["VISUOTACTILE_STUDY_R"] + "/report.R", report, folder / "published.csv", "without-marked"], check=True, timeout=300, stdout=subprocess.DEVNULL)
    anova = compare(rows, report)
    for question, f in PAPER_F.items():
        assert abs(float(anova[question, "cues"]["F"]) - f) < 1e-6 and float(anova[question, "cues"]["p"]) < 0.001
        assert float(anova[question, "film"]["p"]) > 0.05
    assert float(anova["QA", "film"]["p"]) < 0.05 and float(anova["QB", "film"]["p"]) < 0.05
    page = (report / "report.html").read_text(encoding="utf-8")
    for text in ("<td>F(1,11) = 39.95 p &lt; .001</td><td>F(1, 11) = 39.95, p &lt; .001</td>", "89.00 (SE 2.68)", "60.00 (SE 5.48)"):
        assert text in page, text
    # The paper's numbers beside this study's, on paper, too.
    paper = subprocess.run(["pdftotext", "-layout", report / "report.pdf", "-"], check=True, capture_output=True, text=True).stdout
    beside = paper[paper.index("Published results beside"):paper.index("Analysis of variance")]
    for question, f in PAPER_F.items():
        assert re.search(rf"^{question} +cues +F\(1,11\) = {f} p < .001 +F\(1, 11\) = {f}, p < .001$", beside, re.MULTILINE), beside
    for level, mean, error in (("static", 89, 2.68), ("real", 60, 5.48)):
        assert re.search(rf"^QA +film={level} +mean = {mean} SE {error};.* {mean}.00 \(SE {error}\)$", beside, re.MULTILINE), beside
    if pictures := os.environ.get("PICTURES"):
        shutil.copytree(report, pictures, dirs_exist_ok=True)


def marked_sessions_are_not_used(parent):
    folder = new_study(parent)
    journal = folder / "data/P05.journal"
    text = journal.read_text()
    assert '"step": "3/film", "outcome": "ended"' in text
    journal.write_text(text.replace('"step": "3/film", "outcome": "ended"', '"step": "3/film", "outcome": "ended", "chair": "The tactor board is gone"'))
    assert "marked: 3:chair" in run_study("status", folder)
    said = run_study("report", folder, f"--output={folder}/report")
    assert "11 people analyzed" in said and "left out, as a session is marked: P05" in said, said
    compare([row for row in exported(folder) if row["participant"] != "P05"], folder / "report")
    assert "12 people analyzed" in run_study("report", folder, f"--output={folder}/report", "--with-marked")
    run_study("forget", folder, "P05")
    assert "P05" not in {row["participant"] for row in exported(folder)} and "P05    forgotten" in run_study("status", folder)


def odd_studies(parent):
    """Without factors; 40 questions, with a scale below zero; an answer \"NA\"; a level that study.ini no longer has."""
    folder = pathlib.Path(parent) / "plain"
    folder.mkdir()
    head = "[study]\ntitle=Plain\nconsent=Yes?\nconsent-version=1\n[settings]\nfilm=a.mkv\n"
    questions = "".join(f"[question Q{i}]\ntext=Good?\nlow=-50\nhigh=50\n" for i in range(1, 41)) + "[question E]\nkind=text\ntext=Else?\n"
    (folder / "study.ini").write_text(head + questions)
    run_study("simulate", folder, "--people=4")
    journal = folder / "data/P02.journal"
    journal.write_text(journal.read_text().replace("A simulated answer.", "NA"))
    run_study("report", folder, f"--output={folder}/report")
    means = read(folder / "report/means.csv")
    assert [row["question"] for row in means] == [f"Q{i}" for i in range(1, 41)] and all(row["n"] == "4" for row in means)
    page = (folder / "report/report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png") == 4 and "<td>P02</td><td>E</td><td>NA</td>" in page
    (folder / "study.ini").write_text(head + questions + "[factor touch]\nlevels=off;on;\n")
    answer = subprocess.run([os.environ["STUDY"], "report", folder, f"--output={folder}/report"], capture_output=True, text=True)
    assert answer.returncode == 1 and "levels of 'touch' that study.ini has" in answer.stderr, answer.stderr
    refused = subprocess.run([os.environ["STUDY"], "export", folder, f"--output={folder}/report/answers.csv"], capture_output=True, text=True)
    assert refused.returncode == 1 and "--force" in refused.stderr
    assert (folder / "report/answers.csv").stat().st_mode & 0o777 == 0o600


def power_is_that_of_the_noncentral_f(parent):
    """The printed powers, by a formula: F(1, n − 1) with noncentrality n · effect² / variance of a person's difference of means over films."""
    folder = new_study(parent, "--people=2")
    said = run_study("power", folder, "--effect=10", "--spread=20", "--correlation=0.4", "--studies=4000")
    powers = {int(n): float(power) for n, power in re.findall(r"(\d+) people: power ([\d.]+)", said)}
    assert len(powers) > 2
    for n, power in powers.items():
        variance = 2 * 20 ** 2 * (1 - 0.4) / 3
        expected = 1 - stats.ncf.cdf(stats.f.isf(0.05, 1, n - 1), 1, n - 1, n * 10 ** 2 / variance)
        assert abs(power - expected) < 4 * (expected * (1 - expected) / 4000) ** 0.5 + 0.001, (n, power, expected)
    needed = int(re.search(r"needed: (\d+) people", said).group(1))
    assert powers[needed] >= 0.8 and powers[needed - 1] < 0.8, said


def by_covariances(data, group):
    """p of conditions as Greenhouse and Geisser (Psychometrika 24, 1959) compute it, without contrasts: from sums of squares, and epsilon from the covariances
    of the conditions. Groups count equally (type 3)."""
    n, k = data.shape
    groups = sorted(set(group))
    rest = data - numpy.array([data[group == one].mean(0) for one in groups])[group]
    covariance = rest.T @ rest / (n - len(groups))
    rows, whole = covariance.mean(1), covariance.mean()
    epsilon = k ** 2 * (numpy.trace(covariance) / k - whole) ** 2 / ((k - 1) * ((covariance ** 2).sum() - 2 * k * (rows ** 2).sum() + k ** 2 * whole ** 2))
    codes = numpy.array([[1, *(int(one == other) - int(one == groups[-1]) for other in groups[:-1])] for one in group], float)  # the mean, and sums that are zero
    own = data - data.mean(1, keepdims=True)
    left = lambda design: ((own - design @ numpy.linalg.lstsq(design, own, rcond=None)[0]) ** 2).sum()
    effect = (left(codes[:, 1:]) - left(codes)) if len(groups) > 1 else n * (own.mean(0) ** 2).sum()
    error = ((rest - rest.mean(1, keepdims=True)) ** 2).sum()
    df2 = (k - 1) * (n - len(groups))
    return epsilon, stats.f.sf(effect / (k - 1) / (error / df2), epsilon * (k - 1), epsilon * df2)


def greenhouse_and_geisser_in_power(parent):
    """p of power's analysis for ratings whose conditions have unlike variances: as by covariances, and as R's own anova.mlm has it."""
    generator = numpy.random.default_rng(50)
    folder = pathlib.Path(parent)
    script = """
        arguments <- commandArgs(trailingOnly = TRUE)
        source(file.path(Sys.getenv("VISUOTACTILE_STUDY_R"), "within.R"))
        for (file in arguments) {
          data <- as.matrix(read.csv(file, header = FALSE))
          group <- data[, 1]; y <- data[, -1]
          ours <- p_within(y %*% helmert(ncol(y)), group)
          model <- if (max(group) > 1) lm(y ~ factor(group), contrasts = list("factor(group)" = contr.sum)) else lm(y ~ 1)
          own <- anova(model, X = ~1, test = "Spherical")
          cat(sprintf("%.15g %.15g\\n", ours, own[1, "G-G Pr"]))
        }"""
    expected, files = [], []
    for groups, sizes, k in ((1, [12], 3), (1, [9], 6), (2, [8, 8], 4), (2, [5, 11], 3)):
        group = numpy.repeat(range(groups), sizes)
        data = generator.normal(0, 1, (sum(sizes), 1)) + generator.normal(0, 1, (sum(sizes), k)) * 3.0 ** numpy.arange(k) + numpy.linspace(0, 3, k) + group[:, None]
        expected.append((*by_covariances(data, group), len(set(sizes)) == 1))
        files.append(str(folder / f"{len(files)}.csv"))
        numpy.savetxt(files[-1], numpy.column_stack([group + 1, data]), delimiter=",", fmt="%.17g")
    (folder / "p.R").write_text(script)
    said = subprocess.run(["Rscript", "--vanilla", folder / "p.R", *files], check=True, timeout=300, capture_output=True, text=True).stdout
    found = [tuple(map(float, line.split())) for line in said.splitlines()]
    assert len(found) == len(expected)
    for (epsilon, p, is_even), (ours, own) in zip(expected, found):
        assert epsilon < 0.85 and numpy.isclose(ours, p, rtol=1e-9), (epsilon, p, ours)
        assert not is_even or numpy.isclose(ours, own, rtol=1e-9), (ours, own)  # anova.mlm weighs groups by their sizes


def groups_of_people(parent):
    """A factor between: F by Welch-free two-sample t of people's means, as there are two groups."""
    folder = pathlib.Path(parent) / "study"
    run_study("new", folder, "--length=1", "--side=64")
    change(folder, ("label=Tactile cues\nlevels=without;with;\n# design=between: a participant has one of the levels\ndesign=within", "label=Tactile cues\nlevels=without;with;\ndesign=between"))
    run_study("simulate", folder, "--people=14", "--effect=25")
    run_study("report", folder, f"--output={folder}/report")
    rows = [row for row in exported(folder) if row["session"].isdigit() and row["question"] == "Q1"]
    means = {cue: [numpy.mean([float(row["answer"]) for row in group]) for _, group in itertools.groupby(sorted((row for row in rows if row["cues"] == cue), key=lambda row: row["participant"]), key=lambda row: row["participant"])] for cue in CUES}
    assert [len(means[cue]) for cue in CUES] == [7, 7]
    found = next(row for row in read(folder / "report/anova.csv") if row["question"] == "Q1" and row["effect"] == "cues")
    t, p = stats.ttest_ind(means["with"], means["without"])
    assert numpy.allclose([float(found["F"]), float(found["df2"]), float(found["p"])], [t ** 2, 12, p], rtol=1e-6), found


def missing_packages_are_named(parent):
    folder = new_study(parent, "--people=2")
    answer = subprocess.run([os.environ["STUDY"], "report", folder, f"--output={parent}/report"], env={**os.environ, "PATH": "/nonexistent"}, capture_output=True, text=True)
    assert answer.returncode == 1 and "r-base-core" in answer.stderr and "r-cran-afex" in answer.stderr, answer.stderr
    # R without its packages: a script in their place that says what requireNamespace() would.
    script = pathlib.Path(parent) / "r"
    shutil.copytree(os.environ["VISUOTACTILE_STUDY_R"], script)
    (script / "analysis.R").write_text("requireNamespace <- function(...) FALSE\n" + (script / "analysis.R").read_text())
    answer = subprocess.run([os.environ["STUDY"], "report", folder, f"--output={parent}/report"], env={**os.environ, "VISUOTACTILE_STUDY_R": str(script)}, capture_output=True, text=True)
    assert answer.returncode == 1 and "install r-cran-afex r-cran-emmeans" in answer.stderr, answer.stderr


TESTS = [the_same_as_in_closed_form, a_foreign_folder_is_kept, unknown_factors_are_refused, the_papers_conclusions, marked_sessions_are_not_used, odd_studies, power_is_that_of_the_noncentral_f, greenhouse_and_geisser_in_power, groups_of_people, missing_packages_are_named]

if __name__ == "__main__":
    for test in TESTS:
        if not sys.argv[1:] or test.__name__ in sys.argv[1:]:
            with tempfile.TemporaryDirectory(prefix="study-report-") as parent:
                test(parent)
            print(f"ok {test.__name__}", flush=True)
