// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/stream_type.hpp"

#include "gateways/mapping/mapping.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <set>
#include <string_view>
#include <utility>

namespace gridspace::sdk {
namespace {

using config::Node;
using iec61850::BasicType;

/// Empty: there is none.
std::string_view idl_type(BasicType type) {
    switch (type) {
    case BasicType::boolean:
        return "boolean";
    case BasicType::int8:
    case BasicType::int16:
        return "short";
    case BasicType::int32:
    case BasicType::enumerated:
        return "long";
    case BasicType::int64:
    case BasicType::timestamp: // nanoseconds since 1970
        return "long long";
    case BasicType::uint8:
    case BasicType::position: // 0 intermediate, 1 open, 2 closed, 3 bad
        return "octet";
    case BasicType::uint16:
        return "unsigned short";
    case BasicType::uint32:
    case BasicType::quality: // a bit each
        return "unsigned long";
    case BasicType::uint64:
        return "unsigned long long";
    case BasicType::float32:
        return "float";
    case BasicType::float64:
        return "double";
    case BasicType::visible_string:
        return "string";
    default:
        return {};
    }
}

class Maker {
  public:
    explicit Maker(streams::Stream const& stream) : stream_{stream} {
        out_.name = "Stream_" + identifier(stream.name.name);
        out_.mapping.name = stream.name;
        out_.mapping.fields = Node::map();
        member("long long", "time_ns");
    }
    /// What a stream has in addition to its data set.
    void own(std::string_view type, std::string const& name) {
        member(type, name);
        out_.mapping.fields.set(name, Node::map()).set("from", Node::quoted_text("$" + name));
    }
    void data_set(bool to_stream) {
        for (mapping::Field const& field : mapping::fields_of(stream_.data_set)) {
            std::string_view const type = idl_type(field.type);
            if (type.empty()) {
                continue;
            }
            std::string const name = member(type, identifier(field.name));
            auto const& [to, from] = to_stream ? std::pair{field.name, name} : std::pair{name, field.name};
            out_.mapping.fields.set(to, Node::map()).set("from", Node::quoted_text(from));
        }
    }
    StreamType take() {
        out_.idl = fmt::format("@final struct {} {{\n{}}};\n", out_.name, members_);
        return std::move(out_);
    }
    [[nodiscard]] gateways::MappingConfig& mapping() { return out_.mapping; }
    [[nodiscard]] std::string const& type_name() const { return out_.name; }

  private:
    static std::string identifier(std::string_view name) {
        std::string out{name};
        std::replace_if(out.begin(), out.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
        return out;
    }
    std::string member(std::string_view type, std::string name) {
        while (!names_.insert(name).second) {
            name += '_';
        }
        members_ += fmt::format("    {} {};\n", type, name);
        return name;
    }

    streams::Stream const& stream_;
    StreamType out_;
    std::set<std::string> names_;
    std::string members_;
};

} // namespace

StreamType type_of_read(streams::Stream const& stream) {
    Maker maker{stream};
    maker.own("boolean", "alive");
    if (stream.kind == streams::Kind::smv) {
        maker.own("unsigned short", "smp_cnt");
        maker.own("octet", "smp_synch");
    } else {
        maker.own("unsigned long", "st_num");
        maker.own("unsigned long", "sq_num");
        maker.mapping().write_on = gateways::MappingConfig::WriteOn::message;
    }
    maker.data_set(false);
    maker.mapping().from.stream = stream.name;
    maker.mapping().to.topic = stream.name;
    maker.mapping().to.type.name = maker.type_name();
    maker.mapping().first_line.on_finding = gateways::FirstLineConfig::OnFinding::ignore;
    return maker.take();
}

StreamType type_of_written(streams::Stream const& stream) {
    Maker maker{stream};
    maker.data_set(true);
    maker.mapping().from.topic = stream.name;
    maker.mapping().from.type.name = maker.type_name();
    maker.mapping().to.stream = stream.name;
    return maker.take();
}

} // namespace gridspace::sdk
