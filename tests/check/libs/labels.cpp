// SPDX-License-Identifier: LGPL-2.1-or-later
#include <stdexcept>
#include <string>
#include <vector>

#include "quality/labels.h"
#include "support/felt.h"
#include "support/temporary_file.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using quality::LabelJudge;
using quality::LabelScores;

namespace {

const std::string kHead = "start,end,verdict,cells,strength,what\n";

std::vector<quality::Label>
labels(const std::string &lines)
{
  const TemporaryFile file(kHead + lines, ".csv");
  return quality::read_labels(file.path);
}

} // namespace

CHECK_TEST(test_scores)
{
  LabelJudge judge(labels("0,1,quiet,,,black\n1,2.2,felt,4 5,2,a ball\n2.2,3,allowed,*,,cut\n"
                          "3,4,allowed,0,,a title\n"));
  judge.frame(0ms, felt(-1));   // right, but not felt
  judge.frame(500ms, felt(4));  // felt where all is quiet
  judge.frame(1000ms, felt(0)); // a wrong cell
  judge.frame(1400ms, felt(5)); // the first of three half seconds is found
  judge.frame(2100ms, felt(4)); // the third, which lasts 0.2 s
  judge.frame(2500ms, felt(8)); // anything may be felt: not judged
  judge.frame(3000ms, felt(0)); // right
  judge.frame(3500ms, felt(1)); // wrong
  judge.frame(4000ms, felt(1)); // beyond the labels
  const LabelScores scores = judge.scores();
  fail_unless_near(scores.felt, 6.0 / 7, 1e-12);
  fail_unless_near(scores.precision, 3.0 / 6, 1e-12);
  fail_unless_near(scores.recall, 2.0 / 3, 1e-12);

  // The same for each span.
  ck_assert_int_eq(static_cast<int>(scores.right.size()), 4);
  ck_assert_int_eq(static_cast<int>(scores.found.size()), 4);
  const quality::Mean right[] = { { 0, 1 }, { 2, 3 }, { 0, 0 }, { 1, 2 } };
  const quality::Mean found[] = { { 0, 0 }, { 2, 3 }, { 0, 0 }, { 0, 0 } };
  for (std::size_t i = 0; i < 4; ++i) {
    fail_unless(scores.right[i].sum == right[i].sum && scores.right[i].count == right[i].count);
    fail_unless(scores.found[i].sum == found[i].sum && scores.found[i].count == found[i].count);
  }
}

/// One favorite cell is no place, also where most spans have it; all right is 1.
CHECK_TEST(test_place)
{
  const auto place = [](const std::vector<int> &cells) {
    LabelJudge judge(labels("0,1,felt,4 5,1,a\n1,2,felt,3 4,1,b\n2,3,felt,0,1,c\n3,4,quiet,,,d\n"));
    for (std::size_t i = 0; i < cells.size(); ++i)
      judge.frame(i * 500ms, felt(cells[i]));
    quality::Mean all;
    for (const quality::Mean &span : judge.scores().place)
      all.add(span);
    return all.value();
  };
  fail_unless_near(place({ 4, 4, 4, 4, 4, 4, 4 }), 0, 1e-12);
  fail_unless_near(place({ 5, 5, 3, 3, 0, 0 }), 1, 1e-12);
  // Of cells 4, 4, 4, 5, 0, 0 the chances of the spans are 4/6, 3/6 and 2/6: (5 - 3) / (6 - 3).
  fail_unless_near(place({ 4, 4, 4, 5, 0, 0 }), 2.0 / 3, 1e-12);
}

CHECK_TEST(test_nothing_felt)
{
  LabelJudge judge(labels("0,1,quiet,,,black\n"));
  judge.frame(0ms, felt(-1));
  const LabelScores scores = judge.scores();
  fail_unless_near(scores.felt, 0, 0);
  fail_unless_near(scores.precision, 1, 0);
  fail_unless_near(scores.recall, 1, 0);
}

CHECK_TEST(test_faults)
{
  const struct
  {
    const char *lines;
    const char *expected;
  } faults[] = {
    { "0,1,quiet\n", ":2: expected start,end,verdict,cells,strength,what" },
    { "0,x,quiet,,,black\n", ":2: expected seconds, got 'x'" },
    { "0,1,loud,4,2,a ball\n", ":2: expected felt, allowed or quiet, got 'loud'" },
    { "0,1,felt,9,2,a ball\n", ":2: expected cells 0 to 8, got '9'" },
    { "0,1,felt,,2,a ball\n", ":2: expected cells unless it is quiet" },
    { "0,1,quiet,3,,black\n", ":2: expected cells unless it is quiet" },
    { "0,1,quiet,,,black\n2,3,quiet,,,black\n", ":3: expected a span that begins where" },
    { "0,1,felt,4,,a ball\n",
      ":2: expected a strength of 1 to 3 if it is felt, else none, got ''" },
    { "0,1,felt,4,4,a ball\n",
      ":2: expected a strength of 1 to 3 if it is felt, else none, got '4'" },
    { "0,1,quiet,,1,black\n",
      ":2: expected a strength of 1 to 3 if it is felt, else none, got '1'" },
    { "0,0,quiet,,,black\n", ":2: expected a span that begins where" },
  };
  for (const auto &fault : faults) {
    std::string message;
    try {
      labels(fault.lines);
    } catch (const std::runtime_error &error) {
      message = error.what();
    }
    fail_unless(message.find(fault.expected) != std::string::npos, "%s: '%s'", fault.lines,
                message.c_str());
  }
}

CHECK_MAIN(labels)
