// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/boards/memory_bus.h"

#include "support/realtime.h"

#include <cstdint>
#include <span>
#include <thread>

namespace {

class MemoryPort final : public tactor::SerialPort
{
public:
  MemoryPort(Sockets &sockets, MemoryBoard &board, Events events)
      : sockets_(sockets), board_(board), events_(std::move(events)), thread_([this] { run(); })
  {
  }
  ~MemoryPort() override
  {
    {
      std::lock_guard lock(sockets_.mutex);
      quit_ = true;
      sockets_.changed.notify_all();
    }
    thread_.join();
    std::lock_guard lock(sockets_.mutex);
    board_.is_open = false;
    sockets_.changed.notify_all();
  }
  bool write(std::span<const std::uint8_t> bytes) override
  {
    std::lock_guard lock(sockets_.mutex);
    if (is_lost_ || !out_.empty() || bytes.empty() || bytes.size() > kMaxWrite)
      return false;
    sockets_.writer_policy = policy_of(0);
    sockets_.wants_realtime = events_.realtime;
    out_.assign(bytes.begin(), bytes.end());
    sockets_.changed.notify_all();
    return true;
  }

private:
  void run()
  {
    std::unique_lock lock(sockets_.mutex);
    while (!quit_) {
      const bool takes
          = !out_.empty() && !board_.takes_nothing && !board_.takes_nothing_until_reopened;
      std::vector<std::uint8_t> in;
      bool is_written = false;
      if (board_.is_plugged && takes) {
        board_.model.receive(out_.front(), {});
        out_.erase(out_.begin());
        is_written = out_.empty();
        if (board_.bytes_to_live > 0 && --board_.bytes_to_live == 0)
          sockets_.pull(board_);
        sockets_.changed.notify_all();
      }
      while (board_.is_plugged && !board_.model.replies.empty() && in.size() < 50) {
        in.push_back(board_.model.replies.front());
        board_.model.replies.pop_front();
      }
      if (board_.says_nothing || (board_.needs_dtr && !board_.has_dtr))
        in.clear();
      if (!board_.is_plugged) {
        is_lost_ = true;
        lock.unlock();
        events_.lost("it was plugged out");
        lock.lock();
        sockets_.changed.wait(lock, [this] { return quit_; });
      } else if (is_written || !in.empty()) {
        lock.unlock();
        if (!in.empty())
          events_.received(in);
        if (is_written)
          events_.written();
        lock.lock();
      } else if (!takes) {
        sockets_.changed.wait(lock);
      }
    }
  }

  Sockets &sockets_;
  MemoryBoard &board_;
  Events events_;
  std::vector<std::uint8_t> out_;
  bool is_lost_ = false;
  bool quit_ = false;
  std::thread thread_; ///< last, as it uses the others
};

tl::unexpected<tactor::DriverError>
refused(tactor::DriverError::Kind kind, std::string why)
{
  return tl::unexpected(tactor::DriverError{ kind, std::move(why) });
}

} // namespace

MemoryBus::~MemoryBus()
{
  watch(nullptr);
}

tl::expected<std::vector<tactor::SerialDevice>, tactor::DriverError>
MemoryBus::list()
{
  std::lock_guard lock(sockets_.mutex);
  std::vector<tactor::SerialDevice> devices;
  for (const MemoryBoard *board : sockets_.boards)
    devices.push_back(board->device);
  return devices;
}

tl::expected<std::unique_ptr<tactor::SerialPort>, tactor::DriverError>
MemoryBus::open(const tactor::SerialDevice &device, tactor::SerialPort::Events events,
                std::stop_token stop)
{
  using tactor::DriverError;
  MemoryBoard *board = nullptr;
  {
    std::unique_lock lock(sockets_.mutex);
    board = find(device);
    if (!board)
      return refused(DriverError::Kind::not_found, device.name + " was plugged out");
    board->opens++;
    sockets_.changed.notify_all();
    if (board->hangs_on_open) {
      lock.unlock();
      const std::stop_callback wake(stop, [this] {
        const std::lock_guard woken(sockets_.mutex);
        sockets_.changed.notify_all();
      });
      lock.lock();
      sockets_.changed.wait(lock, [&] { return stop.stop_requested(); });
      lock.unlock(); // ~stop_callback may wait for the callback
      return refused(DriverError::Kind::failed, device.name + " was interrupted");
    }
    if (board->refusal)
      return refused(*board->refusal, device.name + " is refused");
    if (board->is_open)
      return refused(DriverError::Kind::busy, device.name + " is in use");
    board->is_open = true;
    board->takes_nothing_until_reopened = false;
    board->has_dtr = board->has_dtr || events.raises_dtr;
    if (board->resets_on_open && events.raises_dtr)
      board->model.restart({});
  }
  return std::make_unique<MemoryPort>(sockets_, *board, std::move(events));
}

tactor::LineUse
MemoryBus::use(const tactor::SerialDevice &device)
{
  std::lock_guard lock(sockets_.mutex);
  const MemoryBoard *board = find(device);
  return board ? board->use : tactor::LineUse{};
}

bool
MemoryBus::is_left(const tactor::SerialDevice &device)
{
  std::lock_guard lock(sockets_.mutex);
  const MemoryBoard *board = find(device);
  return board && board->is_left;
}

tl::expected<void, tactor::DriverError>
MemoryBus::reset(const tactor::SerialDevice &device)
{
  std::lock_guard lock(sockets_.mutex);
  MemoryBoard *board = find(device);
  if (!board)
    return refused(tactor::DriverError::Kind::not_found, device.name + " was plugged out");
  board->pulses++;
  if (!board->resets_on_open)
    return refused(tactor::DriverError::Kind::failed, device.name + " is not reset by DTR");
  board->model.restart({});
  return {};
}

tl::expected<void, tactor::DriverError>
MemoryBus::watch(std::function<void()> changed)
{
  std::lock_guard lock(sockets_.watching);
  sockets_.watcher = std::move(changed);
  return {};
}

MemoryBoard *
MemoryBus::find(const tactor::SerialDevice &device)
{
  for (MemoryBoard *each : sockets_.boards)
    if (each->device == device)
      return each;
  return nullptr;
}
