// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/json_text.hpp"

#include <nlohmann/json.hpp>

namespace gridspace::monitor {

std::string json_text(nlohmann::ordered_json const& json) {
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::shared_ptr<std::string const> share(std::string content) {
    return std::make_shared<std::string const>(std::move(content));
}

} // namespace gridspace::monitor
