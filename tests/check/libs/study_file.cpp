// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A study's key file, and the files that it names.
#include "study_rig.h"

#include "study/study.h"

#include <set>
#include <utility>
#include <vector>

#include "support/check_tests.h"

using study_rig::kStudy;
using study_rig::StudyFolder;

/// The paper's: 12 people, six conditions, each row twice.
CHECK_TEST(test_paper_study)
{
  const auto study = study::read_study(study::paper_study("films/bears.mkv"));
  fail_unless(study.has_value(), "%s", study ? "" : study.error().c_str());
  fail_unless_equals_int(study->people, 12);
  fail_unless(study->least_break > 120, "longer than two minutes");
  fail_unless_equals_uint64(study->conditions().size(), 6);
  fail_unless_equals_uint64(study->square().size(), 6);
  std::set<std::string> films;
  for (const auto &condition : study->conditions())
    films.insert(condition.settings.at("film"));
  fail_unless_equals_uint64(films.size(), 3);
  fail_unless(films.contains("films/bears.mkv"));
}

CHECK_TEST(test_faults_are_named)
{
  const std::string good = kStudy;
  const std::pair<const char *, std::pair<const char *, const char *>> faults[] = {
    { "consent-version=7", { "consent-version=", "[study] consent" } },
    { "intensity=0",
      { "intensity=2", "[level touch off] intensity: expected a number from 0 to 1" } },
    { "intensity=0", { "strength=0", "[level touch off] strength: unknown" } },
    { "kind=likert", { "kind=lickert", "[question QA] kind: expected slider, likert or text" } },
    { "when=touch:on", { "when=touch:up", "[question QA] when" } },
    { "levels=off;on;", { "levels=off;", "[factor touch] levels: expected two or more" } },
    { "[factor touch]", { "[factor session]", "[factor session]" } },
    { "[factor touch]", { "[factor value]", "[factor value]" } },
    { "[factor touch]", { "[factor if]", "[factor if]" } },
    { "[question E]", { "[qestion E]", "[qestion E]: unknown" } },
    { "people=4", { "people=none", "[study] people: expected a number from 1 to 10000" } },
    { "high=100", { "high=0", "[question Q1] high" } },
    { "levels=off;on;", { "levels=off;on;on;", "'on' is there twice" } },
    { "time=at-end",
      { "time=at-end\nwhen=touch:on;", "[question E] when: expected a factor between" } },
    { "when=touch:on;", { "when=touch:on;touch:off;", "[question QA] when: expected one level" } },
  };
  fail_unless(study::read_study(good).has_value());
  for (const auto &[from, to] : faults) {
    std::string text = good;
    const std::size_t at = text.find(from);
    fail_unless(at != std::string::npos, "%s", from);
    text.replace(at, std::string(from).size(), to.first);
    const auto study = study::read_study(text);
    fail_unless(!study.has_value(), "%s", to.first);
    fail_unless(study.error().find(to.second) != std::string::npos, "%s: %s", to.first,
                study.error().c_str());
  }
}

/// A file of the study lies in its folder, and no item takes the place of a question.
CHECK_TEST(test_files_of_a_study)
{
  const StudyFolder files;
  const std::string form = "[questionnaire H]\nkind=likert\nlabels=a;b;\nfile=";
  std::ofstream(files.path() + "/h.txt") << "It felt right\n";
  fail_unless(study::whole_study(form + "h.txt", files.path()).has_value());
  for (const std::string &name :
       std::vector<std::string>{ "../h.txt", files.path() + "/h.txt", "a/../../h.txt", "" }) {
    const auto whole = study::whole_study(form + name, files.path());
    fail_unless(!whole && whole.error().find("in the study's folder") != std::string::npos, "%s",
                name.c_str());
  }
  const auto twice = study::whole_study(form + "h.txt\n[question H1]\ntext=Mine\n", files.path());
  fail_unless(!twice && twice.error().starts_with("[question H1]"));
}

/// So many combinations that a product of them would not fit into memory.
CHECK_TEST(test_too_many_conditions)
{
  std::string text = kStudy;
  for (int i = 0; i < 30; i++)
    text += "[factor f" + std::to_string(i) + "]\nlevels=a;b;\n";
  const auto study = study::read_study(text);
  fail_unless(!study && study.error().find("at most 32 sessions") != std::string::npos);
}

CHECK_MAIN(study_file)
