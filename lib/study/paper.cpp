// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The study of Kim, Lee, Choi 2012, Section 5.
#include "study/study.h"

namespace study {

const char *const kPaperResults = R"csv(question,effect,statistic,value,note
Q1,cues,"F(1,11)",39.95,p < .001
Q2,cues,"F(1,11)",33.05,p < .001
Q3,cues,"F(1,11)",30.87,p < .001
Q4,cues,"F(1,11)",21.79,p < .001
Q1,film,,,no effect
Q2,film,,,no effect
Q3,film,,,no effect
Q4,film,,,no effect
QA,film=static,mean,89,SE 2.68; matched best
QA,film=real,mean,60,SE 5.48; matched worst
QB,film=real,,,the lowest of the films
)csv";

const char *const kQuestionnaireForm
    = R"(# The items of a questionnaire, one a line, in the words that its authors permit.
# Lines that begin with # and empty lines are no items.
#
# The Haptic Experience Inventory (CHI'25, doi 10.1145/3706598.3713834) has 20 items. Copy them from
# the article or its supplement, under its license, and remove the # of [questionnaire HXI] in
# study.ini.
)";

std::string
paper_study(const std::string &film)
{
  // A string list of the key file has semicolons; a film's name is not one.
  return R"(# A study of films with and without touch. "visuotactile-study run" serves it.
# This one is Section 5 of Kim, Lee, Choi 2012. docs/guide/study.md explains the entries.

[study]
title=Films with and without tactile cues
# What the answers are, for figures.
values=Rating
people=12
# Seconds from the end of a film to the next.
break=121
# The order of conditions is a Williams square, whose conditions this number shuffles.
seed=1
# A session is marked as late if 1 % of its commands are later than this, in ms, or if more frames
# than this were dropped, in percent.
latest=20
most-dropped=1
# A longer text may be in a file: consent-file=consent.txt, instructions-file, thanks-file.
consent-version=1
consent=You will see six short films, some with vibration of the chair, and )"
         R"(answer questions about them. Your answers are stored under a number, without )"
         R"(your name. You can stop at any time, without giving a reason, and have your )"
         R"(data removed.
instructions=Lean back, so that you feel the chair. Please wear the earplugs and)"
         R"( the headset until the end. After each film, answer each question with the )"
         R"(slider: 100 is strong agreement, 50 is neutral, 1 is the strongest disagreement.
thanks=Thank you. Please tell the experimenter that you have finished.

# For all sessions. A level may have the same entries: film, intensity, profile, people, sound,
# rate, sensitivity, density, compensation, rows, columns, driver, device, mapping, calibration as
# in visuotactile-play (people: off by default), and noise, the volume of pink noise by headphones,
# 0 to 1.
[settings]
profile=tuned
noise=0.3

# A trial before the first session, whose answers are marked as practice. Without this group: none.
[practice]
film=films/practice.mkv

[factor cues]
label=Tactile cues
levels=without;with;
# design=between: a participant has one of the levels
design=within

[level cues without]
label=Visual only
intensity=0

[level cues with]
label=Visuotactile
intensity=1

[factor film]
label=Film
levels=static;dynamic;real;

[level film static]
label=Static motion
film=films/static-motion.mkv

[level film dynamic]
label=Dynamic motion
film=films/dynamic-motion.mkv

# The paper's was a documentary of two bears in a zoo. Any film of yours will do, such as a minute
# of a nature film under a Creative Commons license.
[level film real]
label=Real world
film=)" + film
         + R"(

[question Q1]
text=How interesting did you find the system?
# slider, likert or text
kind=slider
low=1
high=100
labels=not at all;neutral;very much;

[question Q2]
text=How much did you like the whole system?
labels=not at all;neutral;very much;

[question Q3]
text=How much were you immersed in the movie with the given system?
labels=not at all;neutral;very much;

[question Q4]
text=How well did you understand the contents of the movie?
labels=not at all;neutral;very well;

[question QA]
text=How well were the vibrations matched with the movie?
labels=not at all;neutral;very well;
# Asked only in sessions with this level.
when=cues:with;

[question QB]
text=How much did the vibrations improve the immersion into the movie?
labels=not at all;neutral;very much;
when=cues:with;

[question survey]
text=What do you think of the whole system?
kind=text
# Once, after the last session. Else: after-film
time=at-end

# A second questionnaire, whose items are in a file, one a line.
#[questionnaire HXI]
#file=questionnaire.txt
#kind=likert
#labels=strongly disagree;disagree;neutral;agree;strongly agree;
#when=cues:with;
)";
}

} // namespace study
