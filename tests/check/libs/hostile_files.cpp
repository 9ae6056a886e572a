// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Malicious input other than tracks: calibrations, recordings, traces, measurements and a board's
// bytes. Each is read or refused with a reason, within one gibibyte of memory and the time limit of
// a test.
#include "calibration/calibration.h"
#include "calibration/recording.h"
#include "tactor/command_trace.h"
#include "tactor/drivers/firmata_board.h"
#include "tools/tactor-calibrate/audio_file.h"
#include "tools/tactor-calibrate/session.h"

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <netinet/in.h>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hostile.h"

#include "support/check_tests.h"

using namespace tactor;

namespace {

constexpr const char *kTraceHeader = "issued_ns,due_ns,effect_ns,tactor,volts\n";
constexpr const char *kCalibration = "[Calibration]\nversion=1\n[Tactor 0]\n";

/// Whether the file is read. If not, the error message is short.
bool
is_read(const std::function<void()> &read)
{
  try {
    read();
    return true;
  } catch (const std::runtime_error &error) {
    assert_short(error.what());
  } catch (const std::invalid_argument &error) {
    fail_unless(error.what()[0] != '\0');
  }
  return false;
}

template <typename File>
bool
is_read(const tl::expected<File, std::string> &read)
{
  if (!read)
    assert_short(read.error());
  return read.has_value();
}

bool
is_calibration(const std::string &path)
{
  return is_read(read_calibration(path));
}

/// A header of a 16-bit WAV file.
std::string
wav(std::uint32_t riff_size, std::uint16_t channels, std::uint32_t rate, std::uint32_t data_size)
{
  std::string header;
  const auto add = [&](std::uint64_t number, int bytes) {
    for (int i = 0; i < bytes; i++)
      header += static_cast<char>(number >> (8 * i) & 0xff);
  };
  header += "RIFF";
  add(riff_size, 4);
  header += "WAVEfmt ";
  add(16, 4);
  add(1, 2);
  add(channels, 2);
  add(rate, 4);
  add(std::uint64_t{ 2 } * channels * rate, 4);
  add(std::uint64_t{ 2 } * channels, 2);
  add(16, 2);
  header += "data";
  add(data_size, 4);
  return header;
}

} // namespace

CHECK_TEST(test_files_of_two_gigabytes)
{
  limit_memory();
  const TemporaryFolder folder;
  const std::string path = folder.file("zeros", "");
  std::filesystem::resize_file(path, 2048 * kMiB); // one line, a sparse file
  fail_if(is_calibration(path));
  fail_if(is_read(read_csv_recording(path)));
  fail_if(is_read(read_command_trace(path)));
  std::filesystem::rename(path, folder.file("session.ini"));
  fail_if(is_read([&] { Session::open(folder.path); }));
}

/// Nobody writes to it.
CHECK_TEST(test_pipe)
{
  const TemporaryFolder folder;
  const std::string path = folder.file("pipe.wav");
  fail_unless(mkfifo(path.c_str(), 0600) == 0);
  fail_if(is_read([&] { read_recording(path); }));
}

CHECK_TEST(test_calibrations)
{
  limit_memory();
  const TemporaryFolder folder;
  const std::string begin = kCalibration;
  fail_unless(is_calibration(folder.file("c", begin + "latency-ms=5\n")));
  // GKeyFile keeps every line.
  for (const char *line : { "\n", "#\n", "a=\n", "[a]\n" })
    fail_if(is_calibration(folder.file("c", begin + times(8 * kMiB, line))));
  for (const char *piece : { "1;", "9", ";", "a", "\\" })
    for (const char *key : { "rise-table-ms", "rise-quadratic-ms", "vibration", "motor" })
      fail_if(is_calibration(folder.file("c", begin + key + "=" + times(4 * kMiB, piece) + "\n")));
  for (const char *number : { "nan", "inf", "-1", "1e999", "1;2", "" })
    for (const char *key : { "latency-ms", "start-volts", "hold-volts", "fall-ms", "steps-used" })
      fail_if(is_calibration(folder.file("c", begin + key + "=" + number + "\n")), "%s=%s", key,
              number);
  fail_if(is_calibration(folder.file("c", "[Calibration]\nversion=1\n[Tactor 99999999999]\n")));
  fail_if(is_calibration(folder.file("c", "[Calibration]\nversion=1\n[Tactor -1]\n")));
}

CHECK_TEST(test_recordings_as_csv)
{
  limit_memory();
  const TemporaryFolder folder;
  const auto reads = [&](const std::string &text) {
    return is_read(read_csv_recording(folder.file("r.csv", text)));
  };
  fail_unless(reads("0,1\n0.001,2\n0.002,3"));
  for (const char *piece : { "1,", "9", ",", "0 ", "\"" })
    fail_if(reads(times(4 * kMiB, piece)));
  fail_if(reads("0,1\n1," + times(kMiB, "1")));
  fail_if(reads(times(kMiB, "\n")));
  for (const char *number : { "nan", "inf", "-inf", "1e999", "1e300" }) {
    fail_if(reads(std::string("0,1\n1,") + number + "\n"), "%s", number);
    fail_if(reads(std::string("0,1\n") + number + ",1\n"), "%s", number);
  }
  // Times that go back, repeat, or lie so close together that the rate overflows.
  fail_if(reads("0,1\n2,1\n1,1\n"));
  fail_if(reads("0,1\n0,1\n"));
  fail_if(reads("0,1\n1e-300,1\n"));
  fail_if(reads("1,1\n1.0000000000000002,1\n"));
}

CHECK_TEST(test_recordings_as_wav)
{
  const TemporaryFolder folder;
  const auto reads = [&](const std::string &bytes) {
    return is_read([&] { read_recording(folder.file("r.wav", bytes)); });
  };
  const std::string second = times(8000, std::string("\x10\x20", 2));
  fail_unless(reads(wav(36 + 16000, 1, 8000, 16000) + second));
  limit_memory(4); // threads reserve more address space than they use
  // The header promises four gigabytes. Only what the file has is read.
  const std::string path = folder.file("r.wav", wav(0xffffffff, 1, 8000, 0xfffffff0) + second);
  fail_unless(read_recording(path).size() == 8000);
  fail_if(reads(wav(0xffffffff, 1, 8000, 0xfffffff0)));
  reads(wav(36 + 16000, 0, 8000, 16000) + second);
  reads(wav(36 + 16000, 0xffff, 8000, 16000) + second);
  reads(wav(36 + 16000, 1, 0, 16000) + second);
  reads(wav(36 + 16000, 64, 0xffffffff, 16000) + second);
  fail_if(reads(""));
  fail_if(reads(times(4 * kMiB, "RIFF")));
}

/// Playlists and session descriptions refer to other places. Nothing is fetched from there.
CHECK_TEST(test_invalid_recordings)
{
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  socklen_t size = sizeof address;
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  fail_unless(bind(listener, reinterpret_cast<sockaddr *>(&address), size) == 0
              && listen(listener, 4) == 0
              && getsockname(listener, reinterpret_cast<sockaddr *>(&address), &size) == 0);
  const std::string place = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port)) + "/";
  const TemporaryFolder folder;
  const std::string hls = "#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:5\n#EXTINF:5,\n" + place
                          + "a.ts\n#EXT-X-ENDLIST\n";
  const std::string dash
      = "<?xml version=\"1.0\"?><MPD xmlns=\"urn:mpeg:dash:schema:mpd:2011\" "
        "profiles=\"urn:mpeg:dash:profile:isoff-on-demand:2011\" type=\"static\" "
        "minBufferTime=\"PT1S\" mediaPresentationDuration=\"PT5S\"><BaseURL>"
        + place
        + "</BaseURL><Period><AdaptationSet mimeType=\"audio/mp4\"><Representation id=\"1\" "
          "bandwidth=\"1000\"><BaseURL>a.mp4</BaseURL></Representation></AdaptationSet>"
          "</Period></MPD>";
  const std::string sdp = "v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\n"
                          "m=audio 0 RTP/AVP 0\na=control:rtsp://127.0.0.1/\n";
  for (const std::string &text : { hls, dash, sdp })
    fail_if(is_read([&] { read_recording(folder.file("r.wav", text)); }));
  fail_unless(accept(listener, nullptr, nullptr) < 0 && errno == EAGAIN, "somebody was asked");
  close(listener);
}

CHECK_TEST(test_traces)
{
  limit_memory();
  const TemporaryFolder folder;
  const auto reads = [&](const std::string &text) {
    return is_read(read_command_trace(folder.file("t.csv", kTraceHeader + text)));
  };
  fail_unless(reads("0,0,100,0,2.5\n"));
  for (const char *piece : { "9", ",", "1,", "-" })
    fail_if(reads(times(4 * kMiB, piece)));
  fail_if(reads(times(1'000'000, "\n")));
  for (const char *volts : { "nan", "inf", "-1", "1e999", "1e300", "" })
    fail_if(reads(std::string("0,0,100,0,") + volts + "\n"), "%s V", volts);
  fail_if(reads("0,-9223372036854775808,9223372036854775807,0,1\n"));
}

CHECK_TEST(test_measurements)
{
  limit_memory();
  const TemporaryFolder folder;
  const auto opens = [&](const std::string &text) {
    return is_read([&] {
      folder.file("session.ini", "[Session]\n" + text);
      Session::open(folder.path);
    });
  };
  const std::string voltages = "voltage-max=3\nstep-volts=0.5\n";
  fail_unless(opens("tactors=0;1\nrepetitions=1\n" + voltages));
  std::string all;
  for (int i = 0; i < 4096; i++)
    all += std::to_string(i) + ";";
  fail_if(opens("tactors=" + all + "\nrepetitions=100\nvoltage-max=24\nstep-volts=0.05\n"));
  fail_if(opens("tactors=" + times(kMiB, "0;") + "\nrepetitions=1\n" + voltages));
  fail_if(opens(times(kMiB, "#\n")));
  fail_if(opens("tactors=-1\nrepetitions=1\n" + voltages));
  fail_if(opens("repetitions=1\n" + voltages));
  fail_if(opens("tactors=0\nrepetitions=2147483647\n" + voltages));
  for (const char *number : { "nan", "inf", "-1", "1e-300", "1e300" })
    fail_if(
        opens(std::string("tactors=0\nrepetitions=1\nvoltage-max=3\nstep-volts=") + number + "\n"),
        "%s", number);
}

/// Endless messages from a board that never stops sending.
CHECK_TEST(test_boards)
{
  limit_memory();
  FirmataBoard board(Time(0));
  const std::vector<std::uint8_t> data(kMiB, 0x41);
  const std::vector<std::uint8_t> begins(kMiB, 0xf0);
  const std::vector<std::uint8_t> versions(kMiB, 0xf9);
  // 64 MiB, hours of data at 57600 baud.
  const std::uint8_t begin[] = { 0xf0, 0x6c };
  board.received(begin);
  for (int i = 0; i < 64; i++)
    board.received(data);
  for (int i = 0; i < 8; i++) {
    board.received(begins);
    board.received(versions);
  }
  fail_unless(board.pins().empty());
  board.close(Time(0));
}

CHECK_MAIN(hostile_files)
