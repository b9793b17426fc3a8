// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/run_news.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace gridspace::launcher {

void RunNews::tell(nlohmann::ordered_json const& json, bool only_the_newest) {
    std::string line = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    if (only_the_newest) {
        output_.put_latest(std::move(line));
    } else {
        output_.put(line);
    }
}

int RunNews::over(std::optional<Error> const& error) {
    auto const code = static_cast<int>(error ? error->code : ExitCode::ok);
    tell({{"kind", "over"},
          {"code", code},
          {"cause", error ? error->message : ""},
          {"remedy", error ? error->remedy : ""},
          {"left_out", output_.left_out()}});
    output_.drain(std::nullopt);
    return code;
}

} // namespace gridspace::launcher
