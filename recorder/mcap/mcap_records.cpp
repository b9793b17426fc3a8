// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/mcap/mcap_records.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::mcap {

Result<RecordFile> RecordFile::open(std::filesystem::path const& file) {
    RecordFile out;
    std::error_code error;
    out.octets_ = std::filesystem::is_directory(file, error) ? 0 : std::filesystem::file_size(file, error);
    out.stream_.open(file, std::ios::binary);
    if (error || !out.stream_) {
        bool const is_there = std::filesystem::exists(file, error);
        return fail(ExitCode::usage,
                    is_there ? fmt::format("cannot read the recording '{}'", file.string())
                             : fmt::format("there is no '{}'", file.string()),
                    is_there ? "" : "give the folder of a run, its data.mcap, or latest");
    }
    std::array<std::uint8_t, kMagic.size()> magic{};
    out.stream_.read(reinterpret_cast<char*>(magic.data()), magic.size());
    if (magic != kMagic) {
        return fail(ExitCode::usage, fmt::format("'{}' is not an MCAP recording", file.string()));
    }
    out.at_ = kMagic.size();
    return out;
}

bool RecordFile::next(Op& op, std::vector<std::byte>& body, std::string& note) {
    std::array<std::byte, 9> head{};
    stream_.read(reinterpret_cast<char*>(head.data()), head.size());
    if (stream_.gcount() != static_cast<std::streamsize>(head.size())) {
        note = "the file ends without an index: the recorder did not finish";
        return false;
    }
    op = static_cast<Op>(head[0]);
    auto const size = Decoder{std::span{head}.subspan(1)}.number<std::uint64_t>();
    if (size > kLargestRecord) {
        note = fmt::format("a record of {} octets, more than {}: the file is damaged", size, kLargestRecord);
        return false;
    }
    at_ += head.size();
    if (size > octets_ - std::min(at_, octets_)) { // no memory for what a damaged length promises
        note = "the last record is cut: the recorder did not finish";
        return false;
    }
    body.resize(size);
    stream_.read(reinterpret_cast<char*>(body.data()), static_cast<std::streamsize>(size));
    at_ += size;
    if (stream_.gcount() != static_cast<std::streamsize>(size)) { // it became shorter
        note = "the last record is cut: the recorder did not finish";
        return false;
    }
    return true;
}

void RecordFile::go_to(std::uint64_t offset) {
    stream_.clear();
    at_ = std::min(offset, octets_);
    stream_.seekg(static_cast<std::streamoff>(at_));
}

std::uint64_t RecordFile::summary_start() {
    constexpr std::uint64_t kFooter = 9 + 20;
    if (octets_ < 2 * kMagic.size() + kFooter) {
        return 0;
    }
    go_to(octets_ - kMagic.size() - kFooter);
    std::vector<std::byte> body;
    std::string ignored;
    Op op{};
    bool const has = next(op, body, ignored) && op == Op::footer && body.size() == 20;
    return has ? Decoder{body}.number<std::uint64_t>() : 0;
}

Schema read_schema(Decoder& d) {
    return {d.number<std::uint16_t>(), d.text(), d.text(), d.text()};
}

Channel read_channel(Decoder& d) {
    return {d.number<std::uint16_t>(), d.number<std::uint16_t>(), d.text(), d.text(), d.texts()};
}

} // namespace gridspace::mcap
