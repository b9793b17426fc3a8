// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

namespace gridspace::launcher {

/// Shows how a run goes: a line that renews itself on a terminal, a plain line every ten seconds elsewhere, JSON lines on
/// request. What it prints goes to standard error, so that standard output stays for results.
class Progress {
  public:
    enum class Style { terminal, plain, json, quiet };
    Progress(Style style, std::string scenario, double duration_s);

    void note(std::string_view text);                     ///< a line of its own
    void event(double time_s, std::string_view source, std::string_view kind, std::string_view text); ///< as in events.ndjson
    void update(double time_s, unsigned long overruns);
    void finish();

  private:
    void draw(bool last);
    void clear();
    Style style_;
    std::string scenario_;
    double duration_s_;
    double time_s_{0};
    unsigned long overruns_{0};
    bool started_{false}, drawn_{false};
    std::chrono::steady_clock::time_point start_, drawn_at_;
};

} // namespace gridspace::launcher
