// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/analysis.h"
#include "follow/ahead_reader.h"

#include <memory>
#include <string>

/// The maps of the analysis, as tactile-track author makes them. It decodes in one thread of low
/// priority. `start`: the stream time of the film's 0:00. Throws std::runtime_error.
std::unique_ptr<follow::MapSource> open_analysis(const std::string &uri, follow::Time start,
                                                 const AnalysisSettings &settings);

/// The cues of the track in a film's file, text cues in subtitles or KLV. Nothing is decoded.
/// Throws std::runtime_error.
std::unique_ptr<follow::MapSource> open_embedded(const std::string &path, follow::Time start);
