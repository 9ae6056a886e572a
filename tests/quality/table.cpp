// SPDX-License-Identifier: LGPL-2.1-or-later
#include "table.h"

#include <glib.h>
#include <hwy/targets.h>

#include <opencv2/core/version.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <memory>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <thread>
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

/// In lines of at most 100 columns, as prose is.
void
write_lines(std::ostream &out, const std::string &text)
{
  std::istringstream words(text);
  std::size_t column = 0;
  for (std::string word; words >> word;) {
    const auto width = static_cast<std::size_t>(
        std::ranges::count_if(word, [](char c) { return (c & 0xC0) != 0x80; }));
    if (column > 0)
      out << (column + 1 + width > 100 ? "\n" : " ");
    column = column > 0 && column + 1 + width <= 100 ? column + 1 + width : width;
    out << word;
  }
  if (column > 0)
    out << "\n\n";
}

/// The processor's name, as the kernel has it.
std::string
processor()
{
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name"))
      return line.substr(line.find(": ") + 2);
  return "unknown processor";
}

/// The widest instruction set that Highway chooses here.
std::string
instruction_set()
{
  const std::int64_t targets = hwy::SupportedTargets();
  return hwy::TargetName(targets & -targets);
}

} // namespace

void
write_page_head(std::ostream &out, const std::string &title,
                const std::vector<std::string> &command)
{
  out << "# " << title << "\n\nMade by `";
  for (std::size_t i = 0; i < command.size(); ++i)
    out << (i > 0 ? " " : "") << command[i];
  const std::unique_ptr<gchar, decltype(&g_free)> system(g_get_os_info(G_OS_INFO_KEY_PRETTY_NAME),
                                                         g_free);
  out << "`; do not edit.\n\n";
  std::string load = "unknown";
  std::ifstream("/proc/loadavg") >> load;
  write_lines(out, processor() + ", " + std::to_string(std::thread::hardware_concurrency())
                       + " CPUs, " + instruction_set() + ", load average " + load + "; "
                       + (system ? system.get() : "unknown system") + ", GCC " __VERSION__
                       + ", OpenCV " CV_VERSION ".");
}

Table::Table(std::string title, std::string caption, std::vector<std::string> header)
    : title_(std::move(title)), caption_(std::move(caption)), header_(std::move(header))
{
}

void
Table::add(std::vector<std::string> row, bool on_page)
{
  if (row.size() != header_.size())
    throw std::invalid_argument("a row has as many cells as the header");
  rows_.push_back({ std::move(row), on_page });
}

void
Table::write_markdown(std::ostream &out, const std::string &every) const
{
  out << "## " << title_ << "\n\n";
  write_lines(out, caption_ + (every.empty() ? "" : " [All figures](" + every + ")."));
  if (std::ranges::none_of(rows_, &Row::on_page))
    return;
  write_row(out, header_);
  for (std::size_t i = 0; i < header_.size(); ++i)
    out << "|---";
  out << "|\n";
  for (const auto &row : rows_)
    if (row.on_page)
      write_row(out, row.cells);
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
    line(title_, row.cells);
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
