// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/line_output.hpp"

#include <chrono>
#include <string>
#include <string_view>
#include <unistd.h>

namespace gridspace::launcher {

/// Shows how a run goes: a line that renews itself on a terminal, a plain line every ten seconds elsewhere, JSON lines
/// on request. What it prints goes to standard error, so that standard output stays for results. It never waits for who
/// reads that: of how far the run is, only the newest is kept meanwhile, of everything else a megabyte.
class Progress {
  public:
    enum class Style { terminal, plain, json, quiet };
    Progress(Style style, std::string scenario, double duration_s);
    ~Progress(); ///< prints what waits
    Progress(Progress const&) = delete;
    Progress& operator=(Progress const&) = delete;

    void note(std::string_view text); ///< a line of its own
    void event(double time_s, std::string_view source, std::string_view kind,
               std::string_view text); ///< as in events.ndjson
    void update(double time_s, unsigned long overruns);
    void finish(); ///< waits for a moment
    void flush() { output_.flush(); }
    /// To poll for POLLOUT, then to flush; -1: nothing waits.
    [[nodiscard]] int waits_for() const { return output_.waits() ? output_.fd() : -1; }
    /// What nobody has read yet.
    [[nodiscard]] std::string take_unread();

  private:
    void draw(bool last);
    void show(std::string text, bool last); ///< how far it is
    void clear();
    void print(std::string_view text) { output_.put(text); }
    LineOutput output_{STDERR_FILENO};
    Style style_;
    std::string scenario_;
    double duration_s_;
    double time_s_{0};
    unsigned long overruns_{0};
    bool started_{false}, drawn_{false}, left_out_is_said_{false};
    std::chrono::steady_clock::time_point start_, drawn_at_;
};

} // namespace gridspace::launcher
