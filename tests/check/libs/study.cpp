// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A study's steps and marks, and what is on the disk.
#include "study_rig.h"

#include "study/page.h"
#include "study/simulation.h"
#include "study/table.h"
#include "study/timing.h"

#include <algorithm>
#include <csignal>
#include <map>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/check_tests.h"

using study::Place;
using study::Row;
using study::Step;
using namespace study_rig;

/// One participant from the start to the end, by the steps that the study's text implies.
CHECK_TEST(test_steps)
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

/// What was answered is there for another process at each step, also if the last line is torn.
CHECK_TEST(test_nothing_is_lost)
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

CHECK_TEST(test_one_at_a_time)
{
  const StudyFolder files;
  const auto folder = files.open();
  const auto other = Folder::open(files.path(), Folder::Use::writes);
  fail_unless(!other && other.error().find("is in use") != std::string::npos);
  fail_unless(Folder::open(files.path(), Folder::Use::reads).has_value());
}

CHECK_TEST(test_marks)
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

CHECK_TEST(test_drop_and_forget)
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
  fail_if(files.read("data/P02.journal").find("\"step\"") == std::string::npos);
  fail_unless(folder->forget("P02").has_value());
  fail_unless(folder->forget("P01").has_value());
  fail_unless(!folder->forget("P09").has_value());
  fail_unless(!fs::exists(folder->data("P01")));
  fail_unless(files.read("data/P02.journal").find("\"step\"") == std::string::npos);
  fail_unless(study::answer_table(*folder).find("P02") == std::string::npos);
  Participant *three = *folder->start("0.1");
  fail_unless(three->name() == "P03", "a number is not given again");
  fail_unless(three->place() == place);
}

/// The edit of a study's file changes nothing for those who have begun.
CHECK_TEST(test_changed_study)
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

/// What began as a journal is known, whatever became of it, and blocks nobody else.
CHECK_TEST(test_damaged_journal)
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

/// A list that cannot be read is no empty list.
CHECK_TEST(test_unreadable_data)
{
  const StudyFolder files;
  fail_unless(Folder::open(files.path(), Folder::Use::reads).has_value(), "no data yet");
  std::ofstream(files.path() + "/data") << "x";
  fail_unless(!Folder::open(files.path(), Folder::Use::reads).has_value());
}

/// Without room for the new journal, the participant is still there, to be forgotten later.
CHECK_TEST(test_forget_is_cut_off)
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

/// Without room for an answer, the step is still the same, in memory and on the disk.
CHECK_TEST(test_an_answer_without_room)
{
  const StudyFolder files;
  const auto folder = files.open();
  Participant &one = **folder->start("0.1");
  const std::string before = files.read("data/P01.journal");
  const auto event = one.answer("consent", "7", 1);
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit none{ .rlim_cur = 0, .rlim_max = limit.rlim_max };
  setrlimit(RLIMIT_FSIZE, &none);
  fail_unless(!folder->add(one, *event).has_value());
  setrlimit(RLIMIT_FSIZE, &limit);
  fail_unless(one.step().name == "consent" && one.consent().empty());
  fail_unless(files.read("data/P01.journal") == before);
  fail_unless(folder->add(one, *event).has_value());
  fail_unless(one.consent() == "7");
}

/// The last point of the scale is one of its steps.
CHECK_TEST(test_simulated_answers_are_on_the_scale)
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

/// Commands that are 1, 2, …, 100 ms late.
CHECK_TEST(test_timing)
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

/// Twelve simulated people: each answers each question of each session once; the effect is there.
CHECK_TEST(test_simulated_people)
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

/// Pages are told no condition.
CHECK_TEST(test_pages)
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

CHECK_MAIN_TIMEOUT(study, 120)
