// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/dae_solver.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <ida/ida.h>
#include <map>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunmatrix/sunmatrix_sparse.h>

namespace gridspace::sim::phasor {

struct DaeSolver::Impl {
    DaeProblem& problem;
    DaeOptions options;
    SUNContext context{nullptr};
    void* ida{nullptr};
    N_Vector y{nullptr}, yp{nullptr}, id{nullptr};
    SUNMatrix matrix{nullptr};
    SUNLinearSolver linear{nullptr};
    std::vector<int> slots; ///< of the problem's Jacobian values in the matrix data
    std::vector<double> values;
    std::string failure; ///< of a callback
    bool dense;

    Impl(DaeProblem& p, DaeOptions o) : problem{p}, options{o}, dense{p.size() <= o.dense_up_to} {
        SUNContext_Create(nullptr, &context);
        auto const n = static_cast<sunindextype>(problem.size());
        y = N_VNew_Serial(n, context);
        yp = N_VNew_Serial(n, context);
        id = N_VNew_Serial(n, context);
        std::vector<double> const differential = problem.differential();
        std::copy(differential.begin(), differential.end(), N_VGetArrayPointer(id));
        make_matrix();
    }
    Impl(Impl const&) = delete;
    Impl& operator=(Impl const&) = delete;
    ~Impl() {
        IDAFree(&ida);
        SUNLinSolFree(linear);
        SUNMatDestroy(matrix);
        N_VDestroy(id);
        N_VDestroy(yp);
        N_VDestroy(y);
        SUNContext_Free(&context);
    }

    /// Column-compressed pattern (or full columns), and where each value of the problem goes in it.
    void make_matrix() {
        auto const n = static_cast<sunindextype>(problem.size());
        std::vector<SparsityEntry> const entries = problem.sparsity();
        values.resize(entries.size());
        if (dense) {
            matrix = SUNDenseMatrix(n, n, context);
            for (SparsityEntry const& e : entries) {
                slots.push_back(e.column * static_cast<int>(n) + e.row);
            }
            linear = SUNLinSol_Dense(y, matrix, context);
            return;
        }
        std::map<std::pair<int, int>, int> places; // (column, row), sorted: the order of CSC
        for (SparsityEntry const& e : entries) {
            places.emplace(std::pair{e.column, e.row}, 0);
        }
        matrix = SUNSparseMatrix(n, n, static_cast<sunindextype>(places.size()), CSC_MAT, context);
        sunindextype* pointers = SUNSparseMatrix_IndexPointers(matrix);
        sunindextype* rows = SUNSparseMatrix_IndexValues(matrix);
        std::fill(pointers, pointers + n + 1, 0);
        int next = 0;
        for (auto& [place, slot] : places) {
            slot = next;
            rows[next++] = place.second;
            ++pointers[place.first + 1];
        }
        for (sunindextype c = 0; c < n; ++c) {
            pointers[c + 1] += pointers[c];
        }
        for (SparsityEntry const& e : entries) {
            slots.push_back(places.at({e.column, e.row}));
        }
        pattern_.assign(pointers, pointers + n + 1);
        rows_.assign(rows, rows + next);
        linear = SUNLinSol_KLU(y, matrix, context);
    }

    static std::span<double> span_of(N_Vector v) {
        return {N_VGetArrayPointer(v), static_cast<std::size_t>(N_VGetLength(v))};
    }

    static int residual(realtype t, N_Vector yv, N_Vector ypv, N_Vector fv, void* self) {
        static_cast<Impl*>(self)->problem.residual(t, span_of(yv), span_of(ypv), span_of(fv));
        auto const f = span_of(fv);
        // A residual that is not a number lets IDA try a smaller step.
        return std::all_of(f.begin(), f.end(), [](double v) { return v - v == 0; }) ? 0 : 1;
    }

    static int jacobian(realtype t, realtype c, N_Vector yv, N_Vector ypv, N_Vector, SUNMatrix m, void* self, N_Vector,
                        N_Vector, N_Vector) {
        auto& impl = *static_cast<Impl*>(self);
        impl.problem.jacobian(t, c, span_of(yv), span_of(ypv), impl.values);
        SUNMatZero(m);
        double* data = nullptr;
        if (impl.dense) {
            data = SUNDenseMatrix_Data(m);
        } else {
            // SUNMatZero clears the pattern too.
            std::copy(impl.pattern_.begin(), impl.pattern_.end(), SUNSparseMatrix_IndexPointers(m));
            std::copy(impl.rows_.begin(), impl.rows_.end(), SUNSparseMatrix_IndexValues(m));
            data = SUNSparseMatrix_Data(m);
        }
        for (std::size_t i = 0; i < impl.values.size(); ++i) {
            data[impl.slots[i]] += impl.values[i];
        }
        return 0;
    }

    static int events(realtype t, N_Vector yv, N_Vector, realtype* g, void* self) {
        auto& impl = *static_cast<Impl*>(self);
        impl.problem.event_values(t, span_of(yv), {g, impl.problem.events()});
        return 0;
    }

    static void on_error(int code, char const*, char const* function, char* message, void* self) {
        if (code < 0) {
            static_cast<Impl*>(self)->failure = fmt::format("{}: {}", function, message);
        }
    }

    void create(double t) {
        ida = IDACreate(context);
        IDASetErrHandlerFn(ida, on_error, this);
        IDAInit(ida, residual, t, y, yp);
        IDASStolerances(ida, options.relative_tolerance, options.absolute_tolerance);
        IDASetUserData(ida, this);
        IDASetId(ida, id);
        IDASetLinearSolver(ida, linear, matrix);
        IDASetJacFn(ida, jacobian);
        IDASetMaxNumSteps(ida, 100000);
        if (problem.events() > 0) {
            IDARootInit(ida, static_cast<int>(problem.events()), events);
        }
    }

    std::vector<sunindextype> pattern_, rows_;
};

DaeSolver::DaeSolver(DaeProblem& problem, DaeOptions options) : impl_{std::make_unique<Impl>(problem, options)} {}
DaeSolver::~DaeSolver() = default;

Result<void> DaeSolver::restart(double t, std::span<double> y, std::span<double> yp) {
    Impl& s = *impl_;
    std::copy(y.begin(), y.end(), N_VGetArrayPointer(s.y));
    std::copy(yp.begin(), yp.end(), N_VGetArrayPointer(s.yp));
    if (s.ida == nullptr) {
        s.create(t);
    } else {
        IDAReInit(s.ida, t, s.y, s.yp);
    }
    s.failure.clear();
    // The time scale that CalcIC needs only has a sign and an order of magnitude.
    if (IDACalcIC(s.ida, IDA_YA_YDP_INIT, t + 1e-3) != IDA_SUCCESS) {
        return fail(ExitCode::usage, fmt::format("no consistent state at {} s ({})", t, s.failure));
    }
    IDAGetConsistentIC(s.ida, s.y, s.yp);
    std::copy_n(N_VGetArrayPointer(s.y), y.size(), y.begin());
    std::copy_n(N_VGetArrayPointer(s.yp), yp.size(), yp.begin());
    return {};
}

Result<DaeSolver::Stop> DaeSolver::advance(double until, std::span<double> y, std::span<double> yp) {
    Impl& s = *impl_;
    s.failure.clear();
    IDASetStopTime(s.ida, until);
    double reached = 0;
    int const code = IDASolve(s.ida, until, &reached, s.y, s.yp, IDA_NORMAL);
    if (code < 0) {
        return fail(ExitCode::usage, fmt::format("the phasor solver gave up at {} s ({})", reached, s.failure));
    }
    std::copy_n(N_VGetArrayPointer(s.y), y.size(), y.begin());
    std::copy_n(N_VGetArrayPointer(s.yp), yp.size(), yp.begin());
    Stop stop{reached, {}};
    if (code == IDA_ROOT_RETURN) {
        std::vector<int> found(s.problem.events());
        IDAGetRootInfo(s.ida, found.data());
        for (std::size_t i = 0; i < found.size(); ++i) {
            if (found[i] != 0) {
                stop.events.push_back(static_cast<int>(i));
            }
        }
    }
    return stop;
}

long DaeSolver::steps() const {
    long count = 0;
    if (impl_->ida != nullptr) {
        IDAGetNumSteps(impl_->ida, &count);
    }
    return count;
}

} // namespace gridspace::sim::phasor
