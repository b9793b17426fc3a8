// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/codec.hpp"
#include "bus/key_hash.hpp"
#include "common/idl/key.hpp"
#include "common/idl/native_layout.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace gridspace::sdk {

/// A type of samples, as the bus and as a program in C sees it.
class TopicType {
  public:
    /// `idl_file`: that defines it; empty for one of ours. Fails when it is unknown there, or has no layout in memory.
    [[nodiscard]] static Result<std::shared_ptr<TopicType const>> load(std::string const& name,
                                                                       std::filesystem::path const& idl_file);
    /// Of a text of IDL; `from` is added to what is wrong with it.
    [[nodiscard]] static Result<std::shared_ptr<TopicType const>>
    of_text(std::string const& text, std::string const& name, std::string const& from = {});

    [[nodiscard]] std::string const& name() const { return layout_.root().name; }
    [[nodiscard]] idl::NativeLayout const& layout() const { return layout_; }
    [[nodiscard]] std::string const& layout_json() const { return json_; }
    [[nodiscard]] bus::Codec codec() const; ///< its name is the type's: it must outlive the codec
    /// Of the instance of a sample; nothing for a type without keys.
    [[nodiscard]] std::optional<bus::KeyHash> key_hash(std::span<std::byte const> cdr) const;
    /// Where its int64 member time_ns is, when it has one.
    [[nodiscard]] std::optional<std::size_t> time_offset() const { return time_offset_; }

    explicit TopicType(idl::NativeLayout layout);

  private:
    idl::NativeLayout layout_;
    std::string json_;
    std::optional<std::size_t> time_offset_;
    std::optional<idl::KeyFinder> key_;
};

} // namespace gridspace::sdk
