// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace quality {

/// A table of figures, printed as Markdown or CSV.
class Table
{
public:
  /// The caption says in sentences what the columns are, if their names do not.
  Table(std::string title, std::string caption, std::vector<std::string> header);

  /// Requires as many cells as in the header. A row that is not on the page is only in the CSV.
  void add(std::vector<std::string> row, bool on_page = true);

  /// As a section, with a link to the file that has all figures, if there is one.
  void write_markdown(std::ostream &out, const std::string &every = "") const;
  /// RFC 4180. Each line starts with the title.
  void write_csv(std::ostream &out) const;

private:
  std::string title_;
  std::string caption_;
  std::vector<std::string> header_;
  struct Row
  {
    std::vector<std::string> cells;
    bool on_page;
  };
  std::vector<Row> rows_;
};

/// A section of a page, and a table with every figure, if that has other columns.
struct Section
{
  Table table;
  std::optional<Table> every{};
};

/// How a page of docs/measured begins: its title, the command line that makes it, and what that ran
/// on.
void write_page_head(std::ostream &out, const std::string &title,
                     const std::vector<std::string> &command);

/// A number with that many decimals. NaN is "–".
std::string figure(double value, int digits);
/// A percentage with that many decimals.
std::string percent(double share, int digits = 1);

} // namespace quality
