// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/line_output.hpp"
#include "common/result.hpp"

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace gridspace::launcher {

/// What the supervisor reports to the launcher, as JSON lines. Never waits: whatever the launcher does, the processes
/// are watched.
class RunNews {
  public:
    explicit RunNews(int channel) : output_{channel, kMaxWaiting} {}

    /// `only_the_newest`: a line that the next of its kind replaces while it has not left.
    void tell(nlohmann::ordered_json const& json, bool only_the_newest = false);
    /// The last line: how the run ended. Returns the exit code. Waits until all has left: the launcher may be stopped
    /// (Ctrl-Z); when it dies, so does this process.
    int over(std::optional<Error> const& error);

    [[nodiscard]] bool waits() const { return output_.waits(); }
    void flush() { output_.flush(); }

  private:
    static constexpr std::size_t kMaxWaiting = std::size_t{16} << 20U; ///< some 100,000 lines

    LineOutput output_;
};

} // namespace gridspace::launcher
