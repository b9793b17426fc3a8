// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/pages.hpp"

#include "monitor/app/assets.hpp"

#include <fmt/format.h>

namespace gridspace::monitor {

std::optional<web::Response> page_of(web::Request const& request) {
    std::string const& path = request.target.path;
    for (Asset const& asset : assets()) {
        if (path != asset.path) {
            continue;
        }
        web::Response response;
        response.content_type = std::string{asset.content_type};
        response.etag = std::string{asset.etag};
        if (request.if_none_match == asset.etag) {
            response.status = 304;
            return response;
        }
        bool const packed = !asset.gzip.empty() && request.accept_encoding.find("gzip") != std::string::npos;
        response.body = std::string{packed ? asset.gzip : asset.plain};
        response.content_encoding = packed ? "gzip" : "";
        return response;
    }
    return std::nullopt;
}

} // namespace gridspace::monitor
