// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/temporary_file.h"

#include <fstream>
#include <string>

/// A WAVE file of ones: with it, samples are amplitudes.
class Ones
{
public:
  Ones() : file_("", ".wav")
  {
    std::ofstream out(file_.path, std::ios::binary);
    const char head[]
        = "RIFF\0\0\0\0WAVEfmt \20\0\0\0\3\0\1\0\200\273\0\0\0\356\2\0\4\0\40\0data\10\0\0";
    out.write(head, sizeof head);
    const float ones[] = { 1, 1 };
    out.write(reinterpret_cast<const char *>(ones), sizeof ones);
  }
  std::string properties() const
  {
    return "waveform=sample sample=" + file_.path + " ";
  }

private:
  TemporaryFile file_;
};
