// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A target needs a source: this one is there for the headers that are precompiled for it (GridspaceTargets.cmake).
