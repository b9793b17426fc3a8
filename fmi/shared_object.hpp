// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "fmi/instance.hpp"

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

namespace gridspace::fmi {

/// The binary of an FMU in this process.
class SharedObject {
  public:
    [[nodiscard]] static Result<SharedObject> load(std::filesystem::path const& file, std::string const& fmu,
                                                   Host& host);
    ~SharedObject();
    SharedObject(SharedObject&& other) noexcept;
    SharedObject& operator=(SharedObject&&) = delete;

    /// The function of that name into `function`; a missing one is remembered.
    template <class F>
    void find(F*& function, char const* name) {
        function = reinterpret_cast<F*>(symbol(name));
    }
    [[nodiscard]] std::vector<std::string> const& missing() const { return missing_; }
    [[nodiscard]] bool has(std::string const& name) const;
    /// It stays loaded when this is gone, and `in_use` is remembered as its memory: nobody may ask it to free anything.
    void abandon(std::initializer_list<void*> in_use);

  private:
    explicit SharedObject(void* handle) : handle_{handle} {}
    void* symbol(char const* name);
    void* handle_;
    std::vector<std::string> missing_;
};

} // namespace gridspace::fmi
