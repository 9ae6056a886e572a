// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "desk/document.h"
#include "desk/operation.h"

#include "json/json_reader.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Messages of pages in JSON. All input is checked; an error gives the expected input.
/// docs/design/desk.md has the forms.
namespace desk {

using visuotactile::json::write_text;

template <typename T> using Read = tl::expected<T, std::string>;

/// Whether the text is a name made by a page: 1 to 64 letters and digits.
bool is_name(std::string_view text);

struct EditMessage
{
  std::string page;
  std::string edit;
  std::uint64_t revision = 0;
  std::vector<Splice> splices;
};
Read<EditMessage> read_edit(std::string_view body);
/// Writes an edit in one line, for the journal.
std::string write_edit(const EditMessage &message);

struct OperationMessage
{
  std::uint64_t revision = 0;
  Operation operation;
};
Read<OperationMessage> read_operation(std::string_view body);

/// Messages with the name of their page, such as "writer" and "save".
struct PageMessage
{
  std::string page;
  bool take = false;
  bool give = false;
  bool over = false;
};
Read<PageMessage> read_page(std::string_view body);

struct PositionMessage
{
  std::string page;
  double position = 0; ///< ms
  double rate = 1;
  bool paused = false;
  bool leap = false;
};
Read<PositionMessage> read_position(std::string_view body);

struct FeelMessage
{
  std::string page;
  std::vector<std::uint8_t> levels; ///< percent
  int duration = 0;                 ///< ms
};
Read<FeelMessage> read_feel(std::string_view body);

/// [{"start", "end", "levels", "notes"}, …]
std::string write_cues(const std::vector<Cue> &cues);
/// [{"at", "remove", "insert"}, …]
std::string write_splices(const std::vector<Splice> &splices);

} // namespace desk
