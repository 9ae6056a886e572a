// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/analysis.h"
#include "follow/ahead_reader.h"

#include <memory>
#include <string>

/// The maps that the analysis of a film makes, as tactile-track author does. It decodes in one
/// thread, which gives way to others. `start`: the stream time of the film's 0:00. Throws
/// std::runtime_error.
std::unique_ptr<follow::MapSource> open_analysis(const std::string &uri, follow::Time start,
                                                 const AnalysisSettings &settings);

/// The cues of the track that is in a film's file, of which nothing is decoded: text cues in
/// subtitles, or KLV. Throws std::runtime_error.
std::unique_ptr<follow::MapSource> open_embedded(const std::string &path, follow::Time start);
