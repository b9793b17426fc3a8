// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/mcap/mcap_reader.hpp"

#include "recorder/mcap/mcap_records.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <zlib.h>
#include <zstd.h>

namespace gridspace::mcap {
namespace {

/// Octets at the beginning of a buffer that grows with what is decompressed into it.
constexpr std::size_t kFirstPiece = 1U << 20U;

/// Fills `out` with `size` octets of zstd; false when there are fewer or more, or they are damaged.
bool decompress(ZSTD_DCtx* zstd, std::span<std::byte const> stored, std::size_t size, std::vector<std::byte>& out) {
    ZSTD_DCtx_reset(zstd, ZSTD_reset_session_only);
    ZSTD_DCtx_setParameter(zstd, ZSTD_d_windowLogMax, std::bit_width(kLargestChunk) - 1);
    ZSTD_inBuffer in{stored.data(), stored.size(), 0};
    std::size_t done = 0, left = 1;
    out.resize(std::min(size, std::max(out.capacity(), kFirstPiece)));
    while (left != 0) {
        if (done == out.size() && done < size) {
            out.resize(std::min(size, 2 * out.size()));
        }
        ZSTD_outBuffer piece{out.data() + done, out.size() - done, 0};
        std::size_t const read_before = in.pos;
        left = ZSTD_decompressStream(zstd, &piece, &in);
        done += piece.pos;
        bool const stuck = piece.pos == 0 && in.pos == read_before; // it wants more octets or more room than there are
        if (ZSTD_isError(left) != 0 || stuck) {
            return false;
        }
    }
    return done == size;
}

class Reader {
  public:
    /// Before records: who gets their messages, and how long the file is.
    void begin(std::function<bool(Message const&)> const& handler, std::uint64_t file_octets) {
        handler_ = &handler;
        may_decompress_ = kDecompressed + kDecompressedPerOctet * file_octets;
    }

    /// One record. False to stop: the handler had enough, or the record is damaged (note_ says how).
    bool record(Op op, std::span<std::byte const> body) {
        Decoder d{body};
        switch (op) {
        case Op::schema: {
            Schema s = read_schema(d);
            return check(d, "schema") && (schemas_[s.id] = std::move(s), true);
        }
        case Op::channel: {
            Channel c = read_channel(d);
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
        bool const go_on = (*handler_)(
            {channel->second, schema == schemas_.end() ? none : schema->second, sequence, time, d.take(d.left())});
        stopped_ = !go_on;
        return go_on;
    }

    bool chunk(Decoder& d) {
        begins_ns_ = d.number<std::uint64_t>();
        d.number<std::uint64_t>(); // the end
        auto const size = d.number<std::uint64_t>();
        auto const crc = d.number<std::uint32_t>();
        std::string const compression = d.text();
        std::span<std::byte const> const stored = d.take(d.number<std::uint64_t>());
        if (!check(d, "chunk")) {
            return false;
        }
        if (size > kLargestChunk) {
            return leave_out(fmt::format("a chunk of {} octets, more than {}", size, kLargestChunk));
        }
        std::span<std::byte const> records = stored;
        if (compression == "zstd") {
            if (size > may_decompress_ - std::min(decompressed_, may_decompress_)) {
                outcome.note = fmt::format("it decompresses to more than {} octets and {} times its size: no recording "
                                           "of measurements does; what is behind is not read",
                                           kDecompressed, kDecompressedPerOctet);
                return false;
            }
            decompressed_ += size;
            if (!decompress(zstd_.get(), stored, size, buffer_)) {
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
        outcome.damaged_from_ns = std::min(begins_ns_, outcome.damaged_from_ns.value_or(begins_ns_));
        if (damaged_++ == 0) {
            first_damage_ = std::move(why);
        }
        return true;
    }

    std::function<bool(Message const&)> const* handler_{nullptr};
    std::map<std::uint16_t, Schema> schemas_;
    std::map<std::uint16_t, Channel> channels_;
    std::vector<std::byte> buffer_;
    std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> zstd_{ZSTD_createDCtx(), &ZSTD_freeDCtx};
    bool in_chunk_{false};
    std::uint64_t may_decompress_{0}, decompressed_{0}; ///< octets that are believed, and were there
    std::uint64_t begins_ns_{0};                        ///< of the chunk at hand
    std::uint64_t damaged_{0}, orphans_{0};             ///< chunks, messages of channels that were introduced in them
    std::string first_damage_;
};

/// The summary at the end repeats the schemas and channels: they are known then although the chunk that introduces them
/// is damaged. Chunks have checksums and are believed more.
void read_summary(RecordFile& file, Reader& reader) {
    std::vector<std::byte> body;
    std::string ignored;
    Op op{};
    if (std::uint64_t const start = file.summary_start(); start != 0) {
        file.go_to(start);
        while (file.next(op, body, ignored) && (op == Op::schema || op == Op::channel)) {
            (void)reader.record(op, body);
        }
    }
    reader.outcome = {};
    file.go_to(kMagic.size());
}

} // namespace

Result<ReadOutcome> read_messages(std::filesystem::path const& name,
                                  std::function<bool(Message const&)> const& handler) {
    auto file = RecordFile::open(name);
    if (!file) {
        return std::unexpected{file.error()};
    }
    Reader reader;
    reader.begin(handler, file->octets());
    read_summary(*file, reader);
    std::vector<std::byte> body;
    Op op{};
    while (file->next(op, body, reader.outcome.note) && reader.record(op, body)) {
    }
    return reader.finished();
}

struct GrowingFile::State {
    std::filesystem::path file;
    Reader reader;
    std::uint64_t at{kMagic.size()}; ///< what is before has been read
    bool damaged{false};
};

GrowingFile::GrowingFile(std::filesystem::path file) : state_{std::make_unique<State>()} {
    state_->file = std::move(file);
}

GrowingFile::~GrowingFile() = default;

bool GrowingFile::read_on(std::function<bool(Message const&)> const& handler) {
    auto file = RecordFile::open(state_->file);
    if (!file || state_->damaged || state_->reader.data_ended_) {
        return false;
    }
    state_->reader.begin(handler, file->octets());
    file->go_to(state_->at);
    std::vector<std::byte> body;
    std::string not_whole_yet;
    Op op{};
    std::uint64_t const before = state_->at;
    while (!state_->damaged && file->next(op, body, not_whole_yet)) {
        state_->at = file->at();
        state_->damaged = !state_->reader.record(op, body);
    }
    return state_->at != before;
}

} // namespace gridspace::mcap
