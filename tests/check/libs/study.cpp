// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A study: orders of conditions, places, steps, and what is on the disk.
#include <fstream>

#include "study/folder.h"
#include "study/order.h"
#include "study/page.h"
#include "study/simulation.h"
#include "study/table.h"
#include "study/timing.h"

#include <gst/check/gstcheck.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace fs = std::filesystem;
using study::Event;
using study::Folder;
using study::GivenPlace;
using study::Participant;
using study::Place;
using study::Row;
using study::Step;

namespace {

constexpr const char *kStudy = R"([study]
title=A test
people=4
break=100
consent=Yes?
consent-version=7
thanks=Bye

[settings]
film=a.mkv

[practice]
film=p.mkv

[factor touch]
levels=off;on;

[level touch off]
intensity=0

[factor age]
levels=young;old;
design=between

[question Q1]
text=Good?
low=1
high=100

[question QA]
text=How, "exactly"?
kind=likert
labels=no;so-so;yes;
when=touch:on;

[question E]
text=Else?
kind=text
time=at-end
)";

/// A folder of a study, removed with the object.
class StudyFolder
{
public:
  explicit StudyFolder(const std::string &text = kStudy)
  {
    std::string name = (fs::temp_directory_path() / "visuotactile-study-XXXXXX").string();
    fail_unless(mkdtemp(name.data()) != nullptr);
    path_ = name;
    std::ofstream(path_ + "/study.ini") << text;
  }
  ~StudyFolder()
  {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  StudyFolder(const StudyFolder &) = delete;
  StudyFolder &operator=(const StudyFolder &) = delete;

  const std::string &path() const
  {
    return path_;
  }
  std::unique_ptr<Folder> open(Folder::Use use = Folder::Use::writes) const
  {
    auto folder = Folder::open(path_, use);
    fail_unless(folder.has_value(), "%s", folder ? "" : folder.error().c_str());
    return *std::move(folder);
  }
  std::string read(const std::string &name) const
  {
    std::ifstream file(path_ + "/" + name);
    return { std::istreambuf_iterator<char>(file), {} };
  }

private:
  std::string path_;
};

void
add(Folder &folder, Participant &participant, const Event &event)
{
  const auto added = folder.add(participant, event);
  fail_unless(added.has_value(), "%s", added ? "" : added.error().c_str());
}

/// Answers the step as a page does.
void
answer(Folder &folder, Participant &participant, const std::string &text,
       std::int64_t at = study::now())
{
  const auto event = participant.answer(participant.step().name, text, 10, at);
  fail_unless(event.has_value(), "%s", event ? "" : event.error().c_str());
  add(folder, participant, *event);
}

void
play(Folder &folder, Participant &participant, const std::string &outcome = "ended",
     std::int64_t at = study::now())
{
  const std::string step = participant.step().name;
  add(folder, participant, Event("play", at).add("step", step).add("trace", std::string("t")));
  add(folder, participant,
      Event("played", at)
          .add("step", step)
          .add("outcome", outcome)
          .add("commands", std::int64_t{ 7 })
          .add("frames", std::int64_t{ 9 }));
}

} // namespace

/// Counted by brute force: the definition of a Williams square.
GST_START_TEST(test_williams_squares)
{
  for (std::size_t count = 1; count <= 12; count++) {
    const std::vector<Row> square = study::williams_square(count);
    const std::size_t rows = count > 1 && count % 2 == 1 ? 2 * count : count;
    fail_unless_equals_uint64(square.size(), rows);
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> positions;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> successions;
    for (const Row &row : square) {
      fail_unless_equals_uint64(std::set(row.begin(), row.end()).size(), count);
      for (std::size_t i = 0; i < count; i++) {
        fail_unless(row[i] < count);
        positions[{ i, row[i] }]++;
        if (i > 0)
          successions[{ row[i - 1], row[i] }]++;
      }
    }
    fail_unless_equals_uint64(positions.size(), count * count);
    fail_unless_equals_uint64(successions.size(), count * (count - 1));
    for (const auto &[which, times] : positions)
      fail_unless_equals_uint64(times, rows / count);
    for (const auto &[which, times] : successions)
      fail_unless_equals_uint64(times, rows / count);
  }
}
GST_END_TEST

/// After each number of people, no two rows differ by more than one; of an even number of
/// conditions, neither do positions.
GST_START_TEST(test_places_are_even)
{
  for (const std::size_t count : { 2U, 3U, 5U, 6U }) {
    for (const std::size_t groups : { 1U, 3U }) {
      const std::vector<Row> square = study::williams_square(count);
      std::vector<GivenPlace> given;
      std::map<std::pair<std::size_t, std::size_t>, int> rows;
      for (std::size_t i = 0; i < 3 * groups * square.size(); i++) {
        const Place place = study::next_place(groups, square, given);
        fail_unless(place.group < groups && place.row < square.size());
        given.push_back({ .place = place });
        rows[{ place.group, place.row }]++;
        std::vector<std::size_t> sizes(groups);
        for (const GivenPlace &one : given)
          sizes[one.place.group]++;
        fail_unless(std::ranges::max(sizes) - std::ranges::min(sizes) <= 1);
        int least = 1000;
        for (std::size_t row = 0; row < square.size(); row++)
          least = std::min(least, rows[{ place.group, row }]);
        const int uses = rows[{ place.group, place.row }];
        fail_unless(uses - least <= 1);
        std::map<std::pair<std::size_t, std::size_t>, int> positions;
        int most = 0;
        for (const GivenPlace &one : given)
          if (one.place.group == place.group)
            for (std::size_t at = 0; at < count; at++)
              most = std::max(most, ++positions[{ at, square[one.place.row][at] }]);
        int fewest = most;
        for (std::size_t at = 0; at < count; at++)
          for (std::size_t condition = 0; condition < count; condition++)
            fewest = std::min(fewest, positions[{ at, condition }]);
        fail_unless(most - fewest <= (count % 2 == 0 ? 1 : 2), "%zu conditions, %zu people: %d, %d",
                    count, given.size(), most, fewest);
      }
    }
  }
}
GST_END_TEST

GST_START_TEST(test_places_are_given_again)
{
  const std::vector<Row> square = study::williams_square(6);
  std::vector<GivenPlace> given;
  for (int i = 0; i < 9; i++)
    given.push_back({ .place = study::next_place(1, square, given) });
  for (const std::size_t dropped : { 7U, 2U }) {
    given[dropped].is_free = true;
    const Place again = study::next_place(1, square, given);
    fail_unless(again == given[dropped].place, "row %zu", again.row);
    given.push_back({ .place = again });
  }
}
GST_END_TEST

/// The paper's: 12 people, six conditions, each row twice.
GST_START_TEST(test_paper_study)
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
GST_END_TEST

GST_START_TEST(test_faults_are_named)
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
GST_END_TEST

/// One participant from the start to the end, by the steps that the study's text implies.
GST_START_TEST(test_steps)
{
  const StudyFolder files;
  const auto folder = files.open();
  Participant &one = **folder->start("0.1");
  std::vector<std::string> names;
  for (const Step &step : one.steps())
    names.push_back(step.name);
  const bool on_first = one.condition(1).levels.at("touch") == "on";
  const std::vector<std::string> expected
      = on_first
            ? std::vector<std::string>{ "consent", "0/film", "0/Q1", "1/film", "1/Q1", "1/QA",
                                        "1/break", "2/film", "2/Q1", "end/E",  "done" }
            : std::vector<std::string>{ "consent", "0/film", "0/Q1", "1/film", "1/Q1", "1/break",
                                        "2/film",  "2/Q1",   "2/QA", "end/E",  "done" };
  fail_unless(names == expected);
  fail_unless(!one.answer("consent", "6", 1).has_value(), "another version");
  fail_unless(!one.answer("0/Q1", "50", 1).has_value(), "not yet");
  answer(*folder, one, "7");
  fail_unless(!one.answer("0/film", "", 1).has_value(), "a film is played, not answered");
  play(*folder, one);
  for (const char *wrong : { "0.5", "101", "", "x", "1e9", "nan" })
    fail_unless(!one.answer("0/Q1", wrong, 1).has_value(), "%s", wrong);
  answer(*folder, one, "50");
  constexpr std::int64_t kStart = 1'000'000;
  bool has_rested = false;
  while (one.state() == Participant::State::running) {
    const Step step = one.step();
    if (step.kind == Step::Kind::film) {
      play(*folder, one, "ended", kStart);
    } else if (step.kind == Step::Kind::rest) {
      has_rested = true;
      fail_unless_equals_int64(one.rest_left(kStart + 30'000), 70'000);
      fail_unless_equals_int64(one.rest_left(kStart - 30'000), 100'000); // a clock set back
      fail_unless(!one.answer(step.name, "", 1, kStart + 99'000).has_value());
      answer(*folder, one, "", kStart + 100'000);
    } else {
      if (step.question && step.question->kind == study::Question::Kind::likert) {
        fail_unless(!one.answer(step.name, "2.5", 1).has_value());
        fail_unless(!one.answer(step.name, "4", 1).has_value());
      }
      answer(*folder, one, step.name == "end/E" ? "=a, \"b\"\nc" : "3");
    }
  }
  fail_unless(has_rested);
  fail_unless(one.state() == Participant::State::done);
  fail_unless_equals_uint64(one.answers().size(), 5);
  fail_unless(study::answer_table(*folder).find("\"'=a, \"\"b\"\"\nc\"") != std::string::npos);
}
GST_END_TEST

/// What was answered is there for another process at each step, also if the last line is torn.
GST_START_TEST(test_nothing_is_lost)
{
  const StudyFolder files;
  std::size_t done = 0;
  {
    const auto folder = files.open();
    fail_unless(folder->start("0.1").has_value());
  }
  for (;;) {
    int status = 0;
    const pid_t child = fork();
    if (child == 0) { // goes on with one step, and is killed
      auto folder = Folder::open(files.path(), Folder::Use::writes);
      Participant *one = folder ? (*folder)->unfinished() : nullptr;
      if (one == nullptr || one->steps_done() != done)
        _exit(1);
      const Step step = one->step();
      if (step.kind == Step::Kind::film) {
        if (!(*folder)->add(*one, Event("play").add("step", step.name))
            || !(*folder)->add(
                *one, Event("played").add("step", step.name).add("outcome", std::string("ended"))))
          _exit(2);
      } else {
        const auto event = one->answer(step.name, step.name == "consent" ? "7" : "3", 1,
                                       study::now() + one->rest_left());
        if (!event || !(*folder)->add(*one, *event))
          _exit(3);
      }
      kill(getpid(), SIGKILL);
    }
    waitpid(child, &status, 0);
    fail_unless(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL, "status %d at step %zu", status,
                done);
    done++;
    { // a line that was cut off
      std::ofstream torn(files.path() + "/data/P01.journal", std::ios::app);
      torn << "{\"event\": \"ste";
    }
    const auto folder = files.open(Folder::Use::reads);
    fail_unless_equals_uint64(folder->participants().size(), 1);
    fail_unless_equals_uint64(folder->participants()[0]->steps_done(), done);
    if (folder->participants()[0]->state() == Participant::State::done)
      break;
  }
  fail_unless_equals_uint64(done, 10);
}
GST_END_TEST

GST_START_TEST(test_one_at_a_time)
{
  const StudyFolder files;
  const auto folder = files.open();
  const auto other = Folder::open(files.path(), Folder::Use::writes);
  fail_unless(!other && other.error().find("is in use") != std::string::npos);
  fail_unless(Folder::open(files.path(), Folder::Use::reads).has_value());
}
GST_END_TEST

GST_START_TEST(test_marks)
{
  const StudyFolder files;
  const auto folder = files.open();
  Participant &one = **folder->start("0.1");
  answer(*folder, one, "7");
  play(*folder, one);
  answer(*folder, one, "50");
  fail_unless(one.marks(0).empty());
  const std::string step = one.step().name;
  add(*folder, one, Event("play").add("step", step));
  fail_unless(!folder->add(one, Event("go-on").add("step", "2/film")).has_value());
  add(*folder, one, Event("play").add("step", step)); // the server was killed in the first
  add(*folder, one,
      Event("played")
          .add("step", step)
          .add("outcome", std::string("failed"))
          .add("chair", std::string("The tactor board is gone"))
          .add("commands", std::int64_t{ 10 })
          .add("error_p99_ms", 20.5)
          .add("frames", std::int64_t{ 98 })
          .add("frames_dropped", std::int64_t{ 2 }));
  fail_unless(one.step().name == step, "the experimenter decides");
  add(*folder, one, Event("go-on").add("step", step));
  const std::vector<std::string> marks{ "repeated", "failed", "late", "dropped-frames", "chair" };
  fail_unless(one.marks(1) == marks);
  fail_unless(folder->find("P01")->marks(2).empty(), "not yet");
  while (one.step().kind != Step::Kind::film)
    answer(*folder, one, one.step().kind == Step::Kind::question ? "3" : "",
           study::now() + one.rest_left());
  add(*folder, one, Event("play").add("step", std::string("2/film")));
  add(*folder, one,
      Event("played")
          .add("step", std::string("2/film"))
          .add("outcome", std::string("ended"))
          .add("doubts", std::string("no-noise simulated")));
  const bool has_touch = one.condition(2).levels.at("touch") == "on";
  std::vector<std::string> empty{ "no-noise", "simulated", "not-shown" };
  if (has_touch)
    empty.emplace_back("no-commands");
  fail_unless(one.marks(2) == empty, "nothing was seen or felt");
}
GST_END_TEST

GST_START_TEST(test_drop_and_forget)
{
  const StudyFolder files;
  const auto folder = files.open();
  Participant *one = *folder->start("0.1");
  const Place place = one->place();
  answer(*folder, *one, "7");
  const auto trace = folder->next_trace(*one, 0);
  fail_unless(trace.has_value());
  std::ofstream(folder->data(*trace)) << "x";
  add(*folder, *one, Event("drop"));
  fail_unless(!folder->add(*one, Event("drop")).has_value());
  Participant *two = *folder->start("0.1");
  fail_unless(two->name() == "P02" && two->place() == place, "the place is given again");
  answer(*folder, *two, "7");
  play(*folder, *two);
  answer(*folder, *two, "77");
  fail_unless(folder->forget("P02").has_value());
  fail_unless(folder->forget("P01").has_value());
  fail_unless(!folder->forget("P09").has_value());
  fail_unless(!fs::exists(folder->data("P01")));
  fail_unless(files.read("data/P02.journal").find("77") == std::string::npos);
  fail_unless(study::answer_table(*folder).find("P02") == std::string::npos);
  Participant *three = *folder->start("0.1");
  fail_unless(three->name() == "P03", "a number is not given again");
  fail_unless(three->place() == place);
}
GST_END_TEST

/// The edit of a study's file changes nothing for those who have begun.
GST_START_TEST(test_changed_study)
{
  const StudyFolder files;
  std::size_t steps = 0;
  {
    const auto folder = files.open();
    Participant &one = **folder->start("0.1");
    steps = one.steps().size();
    answer(*folder, one, "7");
  }
  std::ofstream(files.path() + "/study.ini", std::ios::app)
      << "[question Q9]\ntext=More?\n[questionnaire H]\nfile=h.txt\nkind=likert\nlabels=a;b;\n";
  fail_unless(!Folder::open(files.path(), Folder::Use::reads).has_value(), "no h.txt");
  std::ofstream(files.path() + "/h.txt") << "# a form\n\nIt felt right\nIt felt late\n";
  const auto folder = files.open();
  fail_unless_equals_uint64(folder->participants()[0]->steps().size(), steps);
  Participant &two = **folder->start("0.1");
  const auto &questions = two.study().questions;
  fail_unless(questions.back().name == "H2" && questions.back().text == "It felt late");
  fail_unless(questions[questions.size() - 2].labels.size() == 2);
  fail_unless(two.study_sum() != folder->participants()[0]->study_sum());
}
GST_END_TEST

/// A file of the study lies in its folder, and no item takes the place of a question.
GST_START_TEST(test_files_of_a_study)
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
GST_END_TEST

/// So many combinations that a product of them would not fit into memory.
GST_START_TEST(test_too_many_conditions)
{
  std::string text = kStudy;
  for (int i = 0; i < 30; i++)
    text += "[factor f" + std::to_string(i) + "]\nlevels=a;b;\n";
  const auto study = study::read_study(text);
  fail_unless(!study && study.error().find("at most 32 sessions") != std::string::npos);
}
GST_END_TEST

/// What began as a journal is known, whatever became of it, and blocks nobody else.
GST_START_TEST(test_damaged_journal)
{
  const StudyFolder files;
  {
    const auto folder = files.open();
    for (int i = 0; i < 3; i++)
      fail_unless(folder->start("0.1").has_value());
  }
  std::ofstream(files.path() + "/data/P03.journal") << "nonsense\n";
  const auto folder = files.open();
  fail_unless_equals_uint64(folder->participants().size(), 2);
  fail_unless(folder->damaged().contains("P03"));
  fail_unless((*folder->start("0.1"))->name() == "P04", "its number is not given again");
  const auto all = study::overview(*folder, nullptr, study::Phase::ready, 0);
  fail_unless(all.find("{\"name\": \"P03\", \"state\": \"damaged\"") != std::string::npos);
  fail_unless(folder->forget("P03").has_value());
  fail_unless(folder->damaged().empty());
  fail_unless(folder->find("P03")->state() == Participant::State::forgotten);
  // One that the list did not have.
  fs::copy_file(files.path() + "/data/P01.journal", files.path() + "/data/P05.journal");
  const std::string before = files.read("data/P05.journal");
  fail_unless(!folder->start("0.1").has_value());
  fail_unless(files.read("data/P05.journal") == before);
}
GST_END_TEST

/// A list that cannot be read is no empty list.
GST_START_TEST(test_unreadable_data)
{
  const StudyFolder files;
  fail_unless(Folder::open(files.path(), Folder::Use::reads).has_value(), "no data yet");
  std::ofstream(files.path() + "/data") << "x";
  fail_unless(!Folder::open(files.path(), Folder::Use::reads).has_value());
}
GST_END_TEST

/// Without room for the new journal, the participant is still there, to be forgotten later.
GST_START_TEST(test_forget_is_cut_off)
{
  const StudyFolder files;
  {
    const auto folder = files.open();
    Participant *one = *folder->start("0.1");
    answer(*folder, *one, "7");
    std::ofstream(folder->data(*folder->next_trace(*one, 0))) << "x";
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit none{ .rlim_cur = 0, .rlim_max = before.rlim_max };
    setrlimit(RLIMIT_FSIZE, &none);
    fail_unless(!folder->forget("P01").has_value());
    setrlimit(RLIMIT_FSIZE, &before);
  }
  const auto folder = files.open();
  fail_unless(folder->find("P01") != nullptr);
  fail_unless(!fs::exists(folder->data("P01")), "traces first");
  fail_unless(folder->forget("P01").has_value());
  fail_unless((*folder->start("0.1"))->name() == "P02");
}
GST_END_TEST

/// The last point of the scale is one of its steps.
GST_START_TEST(test_simulated_answers_are_on_the_scale)
{
  std::string text = kStudy;
  text.replace(text.find("high=100"), 8, "high=100\nstep=10");
  const StudyFolder files(text);
  const auto folder = files.open();
  for (int i = 0; i < 4; i++) {
    const auto done = study::simulate_participant(*folder, { .effect = 400 });
    fail_unless(done.has_value(), "%s", done ? "" : done.error().c_str());
  }
}
GST_END_TEST

/// Commands that are 1, 2, …, 100 ms late.
GST_START_TEST(test_timing)
{
  const StudyFolder files;
  const std::string path = files.path() + "/trace.csv";
  {
    std::ofstream trace(path);
    trace << "issued_ns,due_ns,effect_ns,tactor,volts\n";
    for (int i = 1; i <= 100; i++)
      trace << 1'000'000'000 + i * 1'000'000 << ",1000000000,1050000000,0,1.5\n";
  }
  const auto timing = study::read_timing(path);
  fail_unless(timing.has_value(), "%s", timing ? "" : timing.error().c_str());
  fail_unless_equals_int64(timing->commands, 100);
  fail_unless_equals_int64(timing->late, 95);
  fail_unless_equals_float(timing->p50, 50);
  fail_unless_equals_float(timing->p99, 99);
  fail_unless_equals_float(timing->max, 100);
}
GST_END_TEST

/// Twelve simulated people: each answers each question of each session once; the effect is there.
GST_START_TEST(test_simulated_people)
{
  const StudyFolder files(study::paper_study("films/bears.mkv"));
  const auto folder = files.open();
  for (int i = 0; i < 12; i++) {
    const auto done = study::simulate_participant(*folder, { .seed = 5, .effect = 40 });
    fail_unless(done.has_value(), "%s", done ? "" : done.error().c_str());
  }
  std::map<Row, int> orders;
  std::map<std::string, std::pair<double, int>> sums;
  for (const auto &one : folder->participants()) {
    Row order{ one->place().row };
    orders[order]++;
    // Practice 4, sessions 4 and with cues 2 more, survey 1.
    fail_unless_equals_uint64(one->answers().size(), 4 + 6 * 4 + 3 * 2 + 1);
    for (const auto &answer : one->answers())
      if (answer.step->session > 0 && answer.step->question->name == "Q1") {
        auto &[sum, count] = sums[one->condition(answer.step->session).levels.at("cues")];
        sum += g_ascii_strtod(answer.text.c_str(), nullptr);
        count++;
      }
  }
  fail_unless_equals_uint64(orders.size(), 6);
  for (const auto &[row, times] : orders)
    fail_unless_equals_int(times, 2);
  // By simulation: ±3.5 is one standard error of the difference.
  const double difference
      = sums["with"].first / sums["with"].second - sums["without"].first / sums["without"].second;
  fail_unless(difference > 26 && difference < 54, "%g", difference);
  const std::string table = study::answer_table(*folder);
  fail_unless_equals_int64(std::ranges::count(table, '\n'), 1 + 12 * (4 + 6 * 4 + 3 * 2 + 1));
}
GST_END_TEST

/// Pages are told no condition.
GST_START_TEST(test_pages)
{
  const StudyFolder files;
  const auto folder = files.open();
  const auto idle = study::page_state(folder->study(), nullptr, study::Phase::ready);
  fail_unless(idle == "{\"title\": \"A test\", \"participant\": null}", "%s", idle.c_str());
  Participant &one = **folder->start("0.1");
  answer(*folder, one, "7");
  const auto film = study::page_state(folder->study(), &one, study::Phase::playing, 0);
  fail_unless(film
                  == "{\"title\": \"A test\", \"participant\": \"P01\", \"sessions\": 2, \"step\": "
                     "{\"name\": \"0/film\", \"kind\": \"film\", \"session\": 0, \"done\": 1, "
                     "\"count\": 10, \"phase\": \"playing\", \"restLeft\": 0}}",
              "%s", film.c_str());
  const auto all = study::overview(*folder, &one, study::Phase::playing, 0);
  fail_unless(all.find("\"condition\": {\"touch\": ") != std::string::npos, "%s", all.c_str());
}
GST_END_TEST

static Suite *
study_suite(void)
{
  Suite *suite = suite_create("study");
  TCase *tests = tcase_create("study");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_williams_squares);
  tcase_add_test(tests, test_places_are_even);
  tcase_add_test(tests, test_places_are_given_again);
  tcase_add_test(tests, test_paper_study);
  tcase_add_test(tests, test_faults_are_named);
  tcase_add_test(tests, test_steps);
  tcase_add_test(tests, test_nothing_is_lost);
  tcase_add_test(tests, test_one_at_a_time);
  tcase_add_test(tests, test_marks);
  tcase_add_test(tests, test_drop_and_forget);
  tcase_add_test(tests, test_changed_study);
  tcase_add_test(tests, test_files_of_a_study);
  tcase_add_test(tests, test_too_many_conditions);
  tcase_add_test(tests, test_damaged_journal);
  tcase_add_test(tests, test_unreadable_data);
  tcase_add_test(tests, test_forget_is_cut_off);
  tcase_add_test(tests, test_simulated_answers_are_on_the_scale);
  tcase_add_test(tests, test_timing);
  tcase_add_test(tests, test_simulated_people);
  tcase_add_test(tests, test_pages);
  return suite;
}

GST_CHECK_MAIN(study)
