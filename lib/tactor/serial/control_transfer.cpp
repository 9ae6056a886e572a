// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/control_transfer.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace tactor {

namespace {

struct FreeTransfer
{
  void operator()(libusb_transfer *transfer) const
  {
    libusb_free_transfer(transfer);
  }
};

void LIBUSB_CALL
is_done(libusb_transfer *transfer)
{
  *static_cast<int *>(transfer->user_data) = 1;
}

int
error_of(libusb_transfer_status status)
{
  switch (status) {
  case LIBUSB_TRANSFER_COMPLETED:
    return LIBUSB_SUCCESS;
  case LIBUSB_TRANSFER_TIMED_OUT:
    return LIBUSB_ERROR_TIMEOUT;
  case LIBUSB_TRANSFER_STALL:
    return LIBUSB_ERROR_PIPE;
  case LIBUSB_TRANSFER_NO_DEVICE:
    return LIBUSB_ERROR_NO_DEVICE;
  case LIBUSB_TRANSFER_CANCELLED:
    return LIBUSB_ERROR_INTERRUPTED;
  case LIBUSB_TRANSFER_ERROR:
  case LIBUSB_TRANSFER_OVERFLOW:
    break;
  }
  return LIBUSB_ERROR_IO;
}

} // namespace

int
control_transfer(const UsbContext &context, libusb_device_handle *handle,
                 const ControlRequest &request, std::chrono::milliseconds patience,
                 const std::stop_token &stop)
{
  std::vector<std::uint8_t> buffer(LIBUSB_CONTROL_SETUP_SIZE + request.data.size());
  libusb_fill_control_setup(buffer.data(), request.type, request.request, request.value,
                            request.index, static_cast<std::uint16_t>(request.data.size()));
  std::ranges::copy(request.data, buffer.begin() + LIBUSB_CONTROL_SETUP_SIZE);

  const std::unique_ptr<libusb_transfer, FreeTransfer> transfer(libusb_alloc_transfer(0));
  if (!transfer)
    return LIBUSB_ERROR_NO_MEM;
  int done = 0;
  libusb_fill_control_transfer(transfer.get(), handle, buffer.data(), is_done, &done,
                               static_cast<unsigned>(patience.count()));
  // Ends the loop's wait below, also one that has not begun yet.
  const std::stop_callback wake(stop, [&] { libusb_interrupt_event_handler(context.get()); });
  if (stop.stop_requested())
    return LIBUSB_ERROR_INTERRUPTED;
  if (const int error = libusb_submit_transfer(transfer.get()); error != LIBUSB_SUCCESS)
    return error;
  bool cancelled = false;
  while (!done) {
    const int error = libusb_handle_events_completed(context.get(), &done);
    const bool failed = error != LIBUSB_SUCCESS && error != LIBUSB_ERROR_INTERRUPTED;
    if (!done && !cancelled && (failed || stop.stop_requested())) {
      libusb_cancel_transfer(transfer.get());
      cancelled = true;
    }
  }
  return error_of(transfer->status);
}

} // namespace tactor
