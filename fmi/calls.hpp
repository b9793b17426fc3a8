// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/instance.hpp"

#include <cfenv>
#include <string>

namespace gridspace::fmi {

/// Calls into an FMU: the host is notified of each, the floating-point environment is as before after it, and what a
/// call says becomes a result.
class Calls {
  public:
    Calls(std::string fmu, Host& host) : fmu_{std::move(fmu)}, host_{host} {}

    /// What `function` returns, whatever that is.
    template <class Function, class... Arguments>
    auto plain(char const* name, Function* function, Arguments... arguments) {
        std::fenv_t before;
        std::fegetenv(&before);
        last_said_.clear();
        host_.enter(name);
        if constexpr (std::is_void_v<decltype(function(arguments...))>) {
            function(arguments...);
            host_.leave();
            std::fesetenv(&before);
        } else {
            auto const out = function(arguments...);
            host_.leave();
            std::fesetenv(&before); // results must not depend on how the FMU likes to round
            return out;
        }
    }

    /// A call that says how it went. Ok and warning are success.
    template <class Function, class... Arguments>
    [[nodiscard]] Result<void> checked(std::string_view about, char const* name, Function* function,
                                       Arguments... arguments) {
        auto const status = static_cast<Status>(plain(name, function, arguments...));
        return judge(status, name, about);
    }
    /// `about`: "of 'y'", "from 3 s"; may be empty.
    [[nodiscard]] Result<void> judge(Status status, char const* name, std::string_view about);

    /// What the FMU logs; from its callback.
    void said(Status status, std::string_view category, std::string_view message) noexcept;

    [[nodiscard]] bool failed() const { return failed_; } ///< it may be freed, and nothing else
    [[nodiscard]] bool fatal() const { return fatal_; }   ///< nothing at all may be called
    [[nodiscard]] std::string const& fmu() const { return fmu_; }

  private:
    std::string fmu_;
    Host& host_;
    std::string last_said_; ///< during the call, the last that is worse than a warning or the last at all
    Status last_status_{Status::ok};
    bool failed_{false}, fatal_{false};
};

} // namespace gridspace::fmi
