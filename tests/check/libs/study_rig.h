// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fstream> // before gstcheck.h, which has a macro `fail`

#include "study/folder.h"

#include <gst/check/gstcheck.h>

#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>

/// A study in a folder, and a participant who goes through it.
namespace study_rig {

namespace fs = std::filesystem;
using study::Event;
using study::Folder;
using study::Participant;

inline constexpr const char *kStudy = R"([study]
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

inline void
add(Folder &folder, Participant &participant, const Event &event)
{
  const auto added = folder.add(participant, event);
  fail_unless(added.has_value(), "%s", added ? "" : added.error().c_str());
}

/// Answers the step as a page does.
inline void
answer(Folder &folder, Participant &participant, const std::string &text,
       std::int64_t at = study::now())
{
  const auto event = participant.answer(participant.step().name, text, 10, at);
  fail_unless(event.has_value(), "%s", event ? "" : event.error().c_str());
  add(folder, participant, *event);
}

inline void
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

} // namespace study_rig
