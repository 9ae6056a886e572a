// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/websocket/server_address.h"

#include "support/contains.h"
#include "support/unwrap.h"

#include "support/check_tests.h"

using namespace tactor;

CHECK_TEST(test_forms)
{
  const auto expect = [](const char *device, const char *name, const char *address) {
    const ServedName served = unwrap(read_served_name(device, 12345));
    assert_text(served.name, name);
    assert_text(served.address, address);
  };
  expect("", "", "127.0.0.1:12345");
  expect("Test Vibrator", "Test Vibrator", "127.0.0.1:12345");
  expect("vest@player", "vest", "player:12345");
  expect("@192.168.1.5:8080", "", "192.168.1.5:8080");
  expect("a@b@host", "a@b", "host:12345");
  expect("vest@[::1]", "vest", "[::1]:12345");
  expect("vest@[::1]:1", "vest", "[::1]:1");
}

CHECK_TEST(test_refused)
{
  for (const char *device :
       { "vest@", "vest@:1", "vest@host:", "vest@host:0", "vest@host:65536", "vest@host:1x",
         "vest@host/path", "vest@ho st", "vest@host?x=1", "vest@[]", "vest@[::1", "vest@host:1:2" })
    assert_contains(refusal_of(read_served_name(device, 12345)).text,
                    { device, "expected a name", "NAME@HOST:PORT" });
}

CHECK_MAIN(server_address)
