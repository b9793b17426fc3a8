// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/shared_object.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <utility>

namespace gridspace::fmi {

Result<SharedObject> SharedObject::load(std::filesystem::path const& file, std::string const& fmu, Host& host) {
    host.enter("the loading of its binary"); // its constructors run
    void* const handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    host.leave();
    if (handle == nullptr) {
        char const* const why = ::dlerror();
        return fail(ExitCode::environment,
                    fmt::format("{}: its binary cannot be loaded: {}", fmu, why == nullptr ? "no reason given" : why),
                    "is a library missing that it needs? `ldd` of the unpacked binary names it");
    }
    return SharedObject{handle};
}

SharedObject::SharedObject(SharedObject&& other) noexcept
    : handle_{std::exchange(other.handle_, nullptr)}, missing_{std::move(other.missing_)} {}

SharedObject::~SharedObject() {
    if (handle_ != nullptr) {
        ::dlclose(handle_);
    }
}

void SharedObject::abandon(std::initializer_list<void*> in_use) {
    static auto* const all = new std::vector<void*>; // never freed: who looks for leaks sees that these are none
    all->insert(all->end(), in_use);
    handle_ = nullptr;
}

bool SharedObject::has(std::string const& name) const {
    return ::dlsym(handle_, name.c_str()) != nullptr;
}

void* SharedObject::symbol(char const* name) {
    void* const found = ::dlsym(handle_, name);
    if (found == nullptr) {
        missing_.emplace_back(name);
    }
    return found;
}

} // namespace gridspace::fmi
