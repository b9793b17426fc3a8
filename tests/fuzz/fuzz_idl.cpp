// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A type description, then (after a NUL) a sample: IDL and CDR of strangers are read by the recorder and the monitor.
#include "common/idl/cdr_visitor.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
    using namespace gridspace::idl;
    struct Count final : Visitor {
        void leaf(std::string_view path, Type const&, Value const& value) override {
            octets += path.size() + to_text(value).size();
        }
        std::size_t octets{0};
    } count;
    std::string_view const all{reinterpret_cast<char const*>(data), size};
    std::size_t const cut = std::min(all.find('\0'), all.size());
    auto const model = parse(all.substr(0, cut));
    if (!model) {
        return 0;
    }
    auto const sample = std::as_bytes(std::span{data, size}).subspan(std::min(size, cut + 1));
    for (std::size_t i = 0; i < std::min<std::size_t>(model->types.size(), 16); ++i) {
        (void)visit(*model, i, sample, count);
        (void)find_integer(*model, i, sample, "time_ns");
        (void)model->is_keyed(i);
    }
    return 0;
}
