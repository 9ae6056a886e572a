// SPDX-License-Identifier: LGPL-2.1-or-later
#include "table.h"

#include <cmath>
#include <cstdio>
#include <ostream>
#include <stdexcept>
#include <utility>

namespace quality {

namespace {

std::string
quoted(const std::string &field)
{
  if (field.find_first_of(",\"\n") == std::string::npos)
    return field;
  std::string text = "\"";
  for (const char c : field)
    text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

void
write_row(std::ostream &out, const std::vector<std::string> &row)
{
  for (const auto &cell : row)
    out << "| " << cell << " ";
  out << "|\n";
}

} // namespace

Table::Table(std::string title, std::vector<std::string> header)
    : title_(std::move(title)), header_(std::move(header))
{
}

void
Table::add(std::vector<std::string> row)
{
  if (row.size() != header_.size())
    throw std::invalid_argument("a row has as many cells as the header");
  rows_.push_back(std::move(row));
}

void
Table::write_markdown(std::ostream &out) const
{
  out << "### " << title_ << "\n\n";
  write_row(out, header_);
  for (std::size_t i = 0; i < header_.size(); ++i)
    out << "|---";
  out << "|\n";
  for (const auto &row : rows_)
    write_row(out, row);
  out << "\n";
}

void
Table::write_csv(std::ostream &out) const
{
  const auto line = [&](const std::string &first, const std::vector<std::string> &cells) {
    out << quoted(first);
    for (const auto &cell : cells)
      out << ',' << quoted(cell);
    out << '\n';
  };
  line("table", header_);
  for (const auto &row : rows_)
    line(title_, row);
}

std::string
figure(double value, int digits)
{
  if (std::isnan(value))
    return "–";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string
percent(double share, int digits)
{
  return std::isnan(share) ? "–" : figure(100 * share, digits) + " %";
}

} // namespace quality
