// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/topic_type.hpp"

#include "bus/topics.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace gridspace::sdk {

TopicType::TopicType(idl::NativeLayout layout)
    : layout_{std::move(layout)}, json_{idl::to_json(layout_)},
      time_offset_{layout_.offset_of("time_ns", idl::Kind::int64)} {
    if (layout_.model().is_keyed(layout_.type())) {
        key_.emplace(layout_.model(), layout_.type());
    }
}

Result<std::shared_ptr<TopicType const>> TopicType::load(std::string const& name,
                                                         std::filesystem::path const& idl_file) {
    std::string text{bus::idl_of_type(name)};
    if (!idl_file.empty()) {
        std::ifstream in{idl_file};
        if (!in.is_open()) {
            return fail(ExitCode::usage, fmt::format("cannot read the IDL file '{}' of '{}'", idl_file.string(), name));
        }
        text.assign(std::istreambuf_iterator<char>{in}, {});
    } else if (text.empty()) {
        return fail(ExitCode::usage, fmt::format("'{}' is no type of Gridspace", name),
                    "name the file that defines it: `idl` beside the topic");
    }
    return of_text(text, name, idl_file.empty() ? "" : fmt::format(" ({})", idl_file.string()));
}

Result<std::shared_ptr<TopicType const>> TopicType::of_text(std::string const& text, std::string const& name,
                                                            std::string const& from) {
    auto model = idl::parse(text);
    if (!model) {
        return fail(model.error().code, model.error().message + from, model.error().remedy);
    }
    auto layout = idl::NativeLayout::create(std::make_shared<idl::Model const>(std::move(*model)), name);
    if (!layout) {
        return fail(layout.error().code, layout.error().message + from, layout.error().remedy);
    }
    return std::make_shared<TopicType const>(std::move(*layout));
}

bus::Codec TopicType::codec() const {
    if (bus::Codec const* const ours = bus::find_codec(name())) {
        return *ours; // the same buffers as everybody else's
    }
    bus::Codec codec;
    codec.type_name = name();
    codec.keyed = key_.has_value();
    return codec;
}

std::optional<bus::KeyHash> TopicType::key_hash(std::span<std::byte const> cdr) const {
    if (!key_) {
        return std::nullopt;
    }
    auto const key = key_->key_of(cdr);
    return key ? std::optional{bus::key_hash(*key, key_->is_short())} : std::nullopt;
}

} // namespace gridspace::sdk
