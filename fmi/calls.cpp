// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/calls.hpp"

#include <fmt/format.h>

namespace gridspace::fmi {

std::string_view name_of(Status status) noexcept {
    switch (status) {
    case Status::ok:
        return "ok";
    case Status::warning:
        return "warning";
    case Status::discard:
        return "discard";
    case Status::error:
        return "error";
    case Status::fatal:
        return "fatal";
    case Status::pending:
        return "pending";
    }
    return "a status that the standard does not know";
}

Result<void> Calls::judge(Status status, char const* name, std::string_view about) {
    if (status == Status::ok || status == Status::warning) {
        if (status == Status::warning && last_said_.empty()) {
            host_.say(status, "",
                      fmt::format("{} {}returned a warning", name, about.empty() ? "" : std::string{about} + " "));
        }
        return {};
    }
    failed_ = true;
    fatal_ = status != Status::discard && status != Status::error;
    return fail(ExitCode::child_died,
                fmt::format("{}: {}{}{} returned {}{}{}", fmu_, name, about.empty() ? "" : " ", about, name_of(status),
                            last_said_.empty() ? "" : ": ", last_said_),
                status == Status::pending ? "steps that go on by themselves (canRunAsynchronuously) are not supported"
                                          : "");
}

void Calls::said(Status status, std::string_view category, std::string_view message) noexcept {
    while (message.ends_with('\n') || message.ends_with('\r')) {
        message.remove_suffix(1);
    }
    try {
        if (last_said_.empty() || status >= last_status_) {
            last_said_ = message.substr(0, 500);
            last_status_ = status;
        }
    } catch (...) { // no memory for a message: the call is judged without it
        last_said_.clear();
    }
    host_.say(status, category, message);
}

} // namespace gridspace::fmi
