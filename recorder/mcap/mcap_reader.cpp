// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/mcap/mcap_reader.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <zlib.h>
#include <zstd.h>

namespace gridspace::mcap {
namespace {

constexpr std::uint64_t kLargestRecord = 256ULL << 20U;

/// Reads little-endian numbers and texts; after a read beyond the end, ok() is false and values are 0.
class Decoder {
  public:
    explicit Decoder(std::span<std::byte const> bytes) : bytes_{bytes} {}
    template <class T>
    T number() {
        std::uint64_t value = 0;
        if (!need(sizeof(T))) {
            return 0;
        }
        for (std::size_t i = 0; i < sizeof(T); ++i) {
            value |= static_cast<std::uint64_t>(bytes_[at_ + i]) << (8 * i);
        }
        at_ += sizeof(T);
        return static_cast<T>(value);
    }
    std::string text() {
        std::span<std::byte const> const raw = take(number<std::uint32_t>());
        return {reinterpret_cast<char const*>(raw.data()), raw.size()};
    }
    std::map<std::string, std::string> texts() {
        Decoder inner{take(number<std::uint32_t>())};
        std::map<std::string, std::string> out;
        while (inner.ok() && inner.left() > 0) {
            std::string key = inner.text();
            out[std::move(key)] = inner.text();
        }
        ok_ = ok_ && inner.ok();
        return out;
    }
    std::span<std::byte const> take(std::uint64_t size) {
        if (!need(size)) {
            return {};
        }
        auto const out = bytes_.subspan(at_, size);
        at_ += size;
        return out;
    }
    [[nodiscard]] std::uint64_t left() const { return bytes_.size() - at_; }
    [[nodiscard]] bool ok() const { return ok_; }

  private:
    bool need(std::uint64_t size) {
        ok_ = ok_ && size <= left();
        return ok_;
    }
    std::span<std::byte const> bytes_;
    std::size_t at_{0};
    bool ok_{true};
};

class Reader {
  public:
    explicit Reader(std::function<bool(Message const&)> const& handler) : handler_{handler} {}

    /// One record. False to stop: the handler had enough, or the record is damaged (note_ says how).
    bool record(Op op, std::span<std::byte const> body) {
        Decoder d{body};
        switch (op) {
        case Op::schema: {
            Schema s{d.number<std::uint16_t>(), d.text(), d.text(), d.text()};
            return check(d, "schema") && (schemas_[s.id] = std::move(s), true);
        }
        case Op::channel: {
            Channel c{d.number<std::uint16_t>(), d.number<std::uint16_t>(), d.text(), d.text(), d.texts()};
            return check(d, "channel") && (channels_[c.id] = std::move(c), true);
        }
        case Op::message:
            return message(d);
        case Op::chunk:
            if (in_chunk_) {
                outcome.note = "a chunk inside a chunk";
                return false;
            }
            return chunk(d);
        case Op::data_end:
            data_ended_ = true;
            return false;
        default:
            return true;
        }
    }

    /// What was read, when the file has been.
    ReadOutcome finished() {
        outcome.complete = (data_ended_ && damaged_ == 0) || stopped_;
        if (damaged_ != 0) {
            outcome.note = fmt::format(
                "{} damaged chunk{} left out ({}){}{}{}", damaged_, damaged_ == 1 ? " was" : "s were", first_damage_,
                orphans_ == 0 ? "" : fmt::format(", {} messages whose channel is in them too", orphans_),
                outcome.note.empty() ? "" : "; ", outcome.note);
        }
        return std::move(outcome);
    }

    ReadOutcome outcome;
    bool data_ended_{false};
    bool stopped_{false};

  private:
    bool check(Decoder const& d, char const* what) {
        if (!d.ok()) {
            outcome.note = fmt::format("a {} record is damaged", what);
        }
        return d.ok();
    }

    bool message(Decoder& d) {
        auto const channel = channels_.find(d.number<std::uint16_t>());
        auto const sequence = d.number<std::uint32_t>();
        auto const time = d.number<std::uint64_t>();
        d.number<std::uint64_t>(); // publish time: the same
        if (!check(d, "message")) {
            return false;
        }
        if (channel == channels_.end()) {
            if (damaged_ == 0) {
                outcome.note = "a message of an unknown channel";
                return false;
            }
            ++orphans_; // the chunk that introduced it is one of the damaged
            return true;
        }
        static Schema const none;
        auto const schema = schemas_.find(channel->second.schema_id);
        ++outcome.messages;
        bool const go_on = handler_(
            {channel->second, schema == schemas_.end() ? none : schema->second, sequence, time, d.take(d.left())});
        stopped_ = !go_on;
        return go_on;
    }

    bool chunk(Decoder& d) {
        d.number<std::uint64_t>(); // times
        d.number<std::uint64_t>();
        auto const size = d.number<std::uint64_t>();
        auto const crc = d.number<std::uint32_t>();
        std::string const compression = d.text();
        std::span<std::byte const> const stored = d.take(d.number<std::uint64_t>());
        if (!check(d, "chunk")) {
            return false;
        }
        if (size > kLargestRecord) {
            return leave_out(fmt::format("a chunk of {} octets", size));
        }
        std::span<std::byte const> records = stored;
        if (compression == "zstd") {
            buffer_.resize(size);
            std::size_t const got = ZSTD_decompress(buffer_.data(), buffer_.size(), stored.data(), stored.size());
            if (ZSTD_isError(got) != 0 || got != size) {
                return leave_out("a chunk cannot be decompressed");
            }
            records = buffer_;
        } else if (!compression.empty()) {
            outcome.note = fmt::format("compression '{}' is not supported", compression);
            return false;
        }
        if (crc != 0 &&
            crc != ::crc32(0, reinterpret_cast<Bytef const*>(records.data()), static_cast<uInt>(records.size()))) {
            return leave_out("the checksum of a chunk is wrong");
        }
        Decoder inner{records};
        in_chunk_ = true;
        bool good = true;
        while (good && inner.left() > 0) {
            auto const op = static_cast<Op>(inner.number<std::uint8_t>());
            std::span<std::byte const> const body = inner.take(inner.number<std::uint64_t>());
            good = check(inner, "chunk") && record(op, body);
        }
        in_chunk_ = false;
        return good;
    }

    /// The chunks behind a damaged one are whole.
    bool leave_out(std::string why) {
        if (damaged_++ == 0) {
            first_damage_ = std::move(why);
        }
        return true;
    }

    std::function<bool(Message const&)> const& handler_;
    std::map<std::uint16_t, Schema> schemas_;
    std::map<std::uint16_t, Channel> channels_;
    std::vector<std::byte> buffer_;
    bool in_chunk_{false};
    std::uint64_t damaged_{0}, orphans_{0}; ///< chunks, messages of channels that were introduced in them
    std::string first_damage_;
};

/// The next record of a file. False at its end, or where it is cut or damaged: `note` says which.
bool next_record(std::istream& stream, Op& op, std::vector<std::byte>& body, std::string& note) {
    std::array<std::uint8_t, 9> head{};
    stream.read(reinterpret_cast<char*>(head.data()), head.size());
    if (stream.gcount() != static_cast<std::streamsize>(head.size())) {
        note = "the file ends without an index: the recorder did not finish";
        return false;
    }
    std::uint64_t size = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        size |= static_cast<std::uint64_t>(head[1 + i]) << (8 * i);
    }
    if (size > kLargestRecord) {
        note = fmt::format("a record of {} octets: the file is damaged", size);
        return false;
    }
    body.resize(size);
    stream.read(reinterpret_cast<char*>(body.data()), static_cast<std::streamsize>(size));
    if (stream.gcount() != static_cast<std::streamsize>(size)) {
        note = "the last record is cut: the recorder did not finish";
        return false;
    }
    op = static_cast<Op>(head[0]);
    return true;
}

/// The summary at the end repeats the schemas and channels: they are known then although the chunk that introduces them
/// is damaged. Chunks have checksums and are believed more.
void read_summary(std::istream& stream, Reader& reader) {
    constexpr std::streamoff kFooter = 9 + 20;
    std::vector<std::byte> body;
    std::string ignored;
    Op op{};
    stream.seekg(-(kFooter + static_cast<std::streamoff>(kMagic.size())), std::ios::end);
    if (stream && next_record(stream, op, body, ignored) && op == Op::footer && body.size() == 20) {
        auto const start = Decoder{body}.number<std::uint64_t>();
        stream.seekg(static_cast<std::streamoff>(std::min<std::uint64_t>(start, INT64_MAX)));
        while (start != 0 && stream && next_record(stream, op, body, ignored) &&
               (op == Op::schema || op == Op::channel)) {
            (void)reader.record(op, body);
        }
    }
    stream.clear();
    reader.outcome = {};
    stream.seekg(static_cast<std::streamoff>(kMagic.size()));
}

} // namespace

Result<ReadOutcome> read_messages(std::filesystem::path const& file,
                                  std::function<bool(Message const&)> const& handler) {
    std::ifstream stream{file, std::ios::binary};
    if (!stream) {
        return fail(ExitCode::usage, fmt::format("cannot read the recording '{}'", file.string()));
    }
    std::array<std::uint8_t, kMagic.size()> magic{};
    stream.read(reinterpret_cast<char*>(magic.data()), magic.size());
    if (magic != kMagic) {
        return fail(ExitCode::usage, fmt::format("'{}' is not an MCAP recording", file.string()));
    }
    Reader reader{handler};
    read_summary(stream, reader);
    std::vector<std::byte> body;
    Op op{};
    while (next_record(stream, op, body, reader.outcome.note) && reader.record(op, body)) {
    }
    return reader.finished();
}

} // namespace gridspace::mcap
