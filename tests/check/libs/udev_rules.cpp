// SPDX-License-Identifier: LGPL-2.1-or-later
//
// data/udev/70-visuotactile.rules, read by the rules of udev(7), grants access to the boards that
// the library uses, and to no other device.
#include "tactor/serial/cdc_acm.h"
#include "tactor/serial/ch340.h"
#include "tactor/serial/ftdi.h"

#include <filesystem>
#include <fnmatch.h>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using tactor::UsbId;

namespace {

std::filesystem::path
rules_file()
{
  const gchar *file = g_getenv("UDEV_RULES");
  fail_unless(file != nullptr, "expected the file in UDEV_RULES");
  return file;
}

/// A match or an assignment: `KEY{attribute}operator"value"`.
struct Term
{
  std::string key; ///< with its attribute, as "ATTR{idVendor}"
  std::string operation;
  std::string value;
};

using Rule = std::vector<Term>;

/// All rules of the file. Fails on a line that udev's grammar does not allow.
std::vector<Rule>
read_rules()
{
  static const std::regex term(
      R"re(\s*([A-Z]+(?:\{[A-Za-z_]+\})?)\s*(==|!=|\+=|=)\s*"([^"]*)"\s*(,|$))re");
  std::ifstream file(rules_file());
  fail_unless(file.is_open(), "%s cannot be read", rules_file().c_str());
  std::vector<Rule> rules;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#')
      continue;
    Rule rule;
    std::smatch match;
    while (std::regex_search(line, match, term, std::regex_constants::match_continuous)) {
      rule.push_back({ match[1], match[2], match[3] });
      line = match.suffix();
    }
    fail_unless(line.empty() && !rule.empty(), "not a rule: %s", line.c_str());
    rules.push_back(rule);
  }
  return rules;
}

using Device = std::map<std::string, std::string>; ///< values by key

/// Whether the value matches "a|b" with wildcards.
bool
matches(const std::string &pattern, const std::string &value)
{
  std::istringstream alternatives(pattern);
  for (std::string one; std::getline(alternatives, one, '|');)
    if (fnmatch(one.c_str(), value.c_str(), 0) == 0)
      return true;
  return false;
}

/// What the rules assign to a device, in the form "TAG+=uaccess".
std::set<std::string>
assignments(const std::vector<Rule> &rules, const Device &device)
{
  std::set<std::string> assigned;
  std::string target; ///< label of the current GOTO
  for (const Rule &rule : rules) {
    bool holds = true;
    for (const auto &[key, operation, value] : rule) {
      if (key == "LABEL" && value == target)
        target.clear();
      if (operation != "==" && operation != "!=")
        continue;
      const auto known = device.find(key);
      const bool same = matches(value, known == device.end() ? "" : known->second);
      holds = holds && same == (operation == "==");
    }
    if (!target.empty() || !holds)
      continue;
    for (const auto &[key, operation, value] : rule) {
      if (key == "GOTO")
        target = value;
      else if (key != "LABEL" && operation != "==" && operation != "!=")
        assigned.insert(key + operation + value);
    }
  }
  fail_unless(target.empty(), "there is no label %s after the jump to it", target.c_str());
  return assigned;
}

std::string
hexadecimal(std::uint16_t number)
{
  g_autofree gchar *text = g_strdup_printf("%04x", number);
  return text;
}

Device
usb_device(std::uint16_t vendor, std::uint16_t product, const char *interfaces)
{
  return { { "ACTION", "add" },
           { "SUBSYSTEM", "usb" },
           { "ENV{DEVTYPE}", "usb_device" },
           { "ENV{ID_USB_INTERFACES}", interfaces },
           { "ATTR{idVendor}", hexadecimal(vendor) },
           { "ATTR{idProduct}", hexadecimal(product) } };
}

constexpr const char *kAcmInterfaces = ":020201:0a0000:";
constexpr const char *kVendorInterfaces = ":ff0000:";
constexpr const char *kKeyboardInterfaces = ":030101:";

template <std::size_t count>
bool
has(const std::array<UsbId, count> &ids, std::uint16_t vendor, std::uint16_t product)
{
  return tactor::is_one_of({ .idVendor = vendor, .idProduct = product }, ids);
}

/// All vendor and product numbers that the rules or the library name, and their neighbors.
std::set<std::uint16_t>
numbers(const std::vector<Rule> &rules)
{
  std::set<std::uint16_t> all{ 0x0001 };
  const auto add = [&](unsigned number) {
    for (const unsigned near : { number - 1, number, number + 1 })
      all.insert(static_cast<std::uint16_t>(near));
  };
  const auto add_all = [&](const auto &ids) {
    for (const UsbId &id : ids) {
      add(id.vendor);
      add(id.product);
    }
  };
  add_all(tactor::kCdcAcmDevices);
  add_all(tactor::kCh340Devices);
  add_all(tactor::kFtdiDevices);
  for (const Rule &rule : rules)
    for (const auto &[key, operation, value] : rule)
      if (key.starts_with("ATTR{id")) {
        std::istringstream alternatives(value);
        for (std::string one; std::getline(alternatives, one, '|');)
          add(static_cast<unsigned>(std::stoul(one, nullptr, 16)));
      }
  return all;
}

} // namespace

/// Access is granted to the boards that the library uses, and to nothing else.
CHECK_TEST(test_boards)
{
  const std::vector<Rule> rules = read_rules();
  const std::set<std::string> given{ "TAG+=uaccess", "ENV{ID_MM_DEVICE_IGNORE}=1",
                                     "ENV{VISUOTACTILE_BOARD}=1" };
  const std::set<std::uint16_t> all = numbers(rules);
  int boards = 0;
  for (const std::uint16_t vendor : all)
    for (const std::uint16_t product : all) {
      const bool has_chip = has(tactor::kCh340Devices, vendor, product)
                            || has(tactor::kFtdiDevices, vendor, product);
      const bool has_acm = has(tactor::kCdcAcmDevices, vendor, product);
      const auto expect = [&](bool is_board, const char *interfaces) {
        boards += is_board;
        if (assignments(rules, usb_device(vendor, product, interfaces))
            != (is_board ? given : std::set<std::string>{}))
          ck_abort_msg("%04x:%04x with %s should%s be a board", vendor, product, interfaces,
                       is_board ? "" : " not");
      };
      expect(has_chip, kVendorInterfaces);
      expect(has_chip, kKeyboardInterfaces);
      expect(has_chip || has_acm, kAcmInterfaces);
    }
  fail_unless(boards > 50);
}

/// Only to the device itself, not to its interfaces or terminals, and not when it is removed.
CHECK_TEST(test_events)
{
  const std::vector<Rule> rules = read_rules();
  const Device mega = usb_device(0x2341, 0x0042, kAcmInterfaces);
  ck_assert_uint_eq(assignments(rules, mega).size(), 3);
  Device other = mega;
  other["ACTION"] = "remove";
  fail_unless(assignments(rules, other).empty());
  other = mega;
  other["ENV{DEVTYPE}"] = "usb_interface";
  fail_unless(assignments(rules, other).empty());
  other = mega;
  other["SUBSYSTEM"] = "tty";
  fail_unless(assignments(rules, other).empty());
}

/// 73-seat-late.rules acts on the tag, so this file must precede it. It uses ID_USB_INTERFACES,
/// which 50-udev-default.rules sets.
CHECK_TEST(test_order)
{
  const std::string name = rules_file().filename();
  fail_unless(name > "50-udev-default.rules" && name < "73-seat-late.rules");
  fail_unless(name.ends_with(".rules"));
}

CHECK_MAIN(udev_rules)
