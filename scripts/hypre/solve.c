/* Solves a pressure equation of benches/pressure with hypre, as the yardstick for Talcum's own solver.
 *
 *   solve SYSTEM TOLERANCE
 *
 * SYSTEM is a file of doubles in the machine's order: counts of cells along x, y, z; then, x fastest, the
 * coefficients of lower faces for x, y, z, the diagonal d, and the right-hand side. Conjugate gradients from zero to
 * |b - A p| <= TOLERANCE |b|, with PFMG and with BoomerAMG as the preconditioner; prints one line for each. */

#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <HYPRE_krylov.h>
#include <HYPRE_parcsr_ls.h>
#include <HYPRE_struct_ls.h>
#include <math.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { MOST_ITERATIONS = 500, REPETITIONS = 3 };

/* The whole system, and the layers of cells along z that this rank owns. */
typedef struct {
    int counts[3];
    double *faces[3], *diagonal, *right;
    int first_layer, last_layer;
} System;

/* What a solve took: seconds, and what was reached. */
typedef struct {
    double setup, solve;
    int iterations;
    double residual;
} Result;

/* Seconds that this process has worked. */
static double worked(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

static void fail(const char *words)
{
    fprintf(stderr, "solve: %s\n", words);
    MPI_Abort(MPI_COMM_WORLD, 1);
    exit(1);
}

static double *numbers(FILE *file, size_t count)
{
    double *values = malloc(count * sizeof *values);
    if (values == NULL || fread(values, sizeof *values, count, file) != count) {
        fail("the file of the system ends too early");
    }
    return values;
}

static System read_system(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        fail("cannot open the file of the system");
    }
    System system;
    double *counts = numbers(file, 3);
    size_t cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
        system.counts[axis] = (int)counts[axis];
        cells *= (size_t)counts[axis];
    }
    free(counts);
    for (int axis = 0; axis < 3; ++axis) {
        system.faces[axis] = numbers(file, cells);
    }
    system.diagonal = numbers(file, cells);
    system.right = numbers(file, cells);
    fclose(file);
    int rank, size;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    system.first_layer = system.counts[2] * rank / size;
    system.last_layer = system.counts[2] * (rank + 1) / size - 1;
    return system;
}

static size_t strides(const System *system, int axis)
{
    size_t plane = (size_t)system->counts[0] * (size_t)system->counts[1];
    return axis == 0 ? 1 : axis == 1 ? (size_t)system->counts[0] : plane;
}

static int place_along(const System *system, size_t cell, int axis)
{
    return (int)(cell / strides(system, axis)) % system->counts[axis];
}

/* The row of a cell: itself, then below and above along x, y, z; zero where there is no neighbour. */
static void row_of(const System *system, size_t cell, double row[7])
{
    row[0] = system->diagonal[cell];
    for (int axis = 0; axis < 3; ++axis) {
        int place = place_along(system, cell, axis);
        int at_top = place + 1 == system->counts[axis];
        double below = place == 0 ? 0.0 : system->faces[axis][cell];
        double above = at_top ? 0.0 : system->faces[axis][cell + strides(system, axis)];
        row[1 + 2 * axis] = -below;
        row[2 + 2 * axis] = -above;
        row[0] += below + above;
    }
}

static size_t first_cell(const System *system)
{
    return (size_t)system->first_layer * strides(system, 2);
}

static size_t own_cells(const System *system)
{
    return (size_t)(system->last_layer - system->first_layer + 1) * strides(system, 2);
}

/* Conjugate gradients with PFMG on a structured grid. */
static Result solve_with_pfmg(const System *system, double tolerance)
{
    int lower[3] = {0, 0, system->first_layer};
    int upper[3] = {system->counts[0] - 1, system->counts[1] - 1, system->last_layer};
    int offsets[7][3] = {{0, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
    int entries[7] = {0, 1, 2, 3, 4, 5, 6};
    HYPRE_StructGrid grid;
    HYPRE_StructGridCreate(MPI_COMM_WORLD, 3, &grid);
    HYPRE_StructGridSetExtents(grid, lower, upper);
    HYPRE_StructGridAssemble(grid);
    HYPRE_StructStencil stencil;
    HYPRE_StructStencilCreate(3, 7, &stencil);
    for (int entry = 0; entry < 7; ++entry) {
        HYPRE_StructStencilSetElement(stencil, entry, offsets[entry]);
    }
    HYPRE_StructMatrix matrix;
    HYPRE_StructMatrixCreate(MPI_COMM_WORLD, grid, stencil, &matrix);
    HYPRE_StructMatrixInitialize(matrix);
    size_t first = first_cell(system), cells = own_cells(system);
    double *rows = malloc(7 * cells * sizeof *rows), *zeros = calloc(cells, sizeof *zeros);
    for (size_t cell = 0; cell < cells; ++cell) {
        row_of(system, first + cell, rows + 7 * cell);
    }
    HYPRE_StructMatrixSetBoxValues(matrix, lower, upper, 7, entries, rows);
    HYPRE_StructMatrixAssemble(matrix);
    HYPRE_StructVector b, x;
    HYPRE_StructVectorCreate(MPI_COMM_WORLD, grid, &b);
    HYPRE_StructVectorCreate(MPI_COMM_WORLD, grid, &x);
    HYPRE_StructVectorInitialize(b);
    HYPRE_StructVectorInitialize(x);
    HYPRE_StructVectorSetBoxValues(b, lower, upper, system->right + first);
    HYPRE_StructVectorSetBoxValues(x, lower, upper, zeros);
    HYPRE_StructVectorAssemble(b);
    HYPRE_StructVectorAssemble(x);
    free(rows);
    free(zeros);

    HYPRE_StructSolver gradients, cycle;
    HYPRE_StructPCGCreate(MPI_COMM_WORLD, &gradients);
    HYPRE_StructPCGSetTol(gradients, tolerance);
    HYPRE_StructPCGSetMaxIter(gradients, MOST_ITERATIONS);
    HYPRE_StructPCGSetTwoNorm(gradients, 1);
    HYPRE_StructPFMGCreate(MPI_COMM_WORLD, &cycle);
    HYPRE_StructPFMGSetMaxIter(cycle, 1);
    HYPRE_StructPFMGSetTol(cycle, 0.0);
    HYPRE_StructPFMGSetZeroGuess(cycle);
    HYPRE_StructPFMGSetRAPType(cycle, 0);   /* Galerkin */
    HYPRE_StructPFMGSetRelaxType(cycle, 2); /* red-black Gauss-Seidel, symmetric */
    HYPRE_StructPCGSetPrecond(gradients, HYPRE_StructPFMGSolve, HYPRE_StructPFMGSetup, cycle);
    Result result;
    double start = worked();
    HYPRE_StructPCGSetup(gradients, matrix, b, x);
    result.setup = worked() - start;
    start = worked();
    HYPRE_StructPCGSolve(gradients, matrix, b, x);
    result.solve = worked() - start;
    HYPRE_StructPCGGetNumIterations(gradients, &result.iterations);
    HYPRE_StructPCGGetFinalRelativeResidualNorm(gradients, &result.residual);
    HYPRE_StructPFMGDestroy(cycle);
    HYPRE_StructPCGDestroy(gradients);
    HYPRE_StructVectorDestroy(b);
    HYPRE_StructVectorDestroy(x);
    HYPRE_StructMatrixDestroy(matrix);
    HYPRE_StructStencilDestroy(stencil);
    HYPRE_StructGridDestroy(grid);
    return result;
}

/* The matrix by rows, without entries that are zero. */
static HYPRE_IJMatrix matrix_of(const System *system)
{
    size_t first = first_cell(system), cells = own_cells(system);
    HYPRE_BigInt lower = (HYPRE_BigInt)first, upper = (HYPRE_BigInt)(first + cells) - 1;
    HYPRE_IJMatrix matrix;
    HYPRE_IJMatrixCreate(MPI_COMM_WORLD, lower, upper, lower, upper, &matrix);
    HYPRE_IJMatrixSetObjectType(matrix, HYPRE_PARCSR);
    HYPRE_IJMatrixInitialize(matrix);
    for (size_t cell = first; cell < first + cells; ++cell) {
        double row[7], values[7];
        HYPRE_BigInt columns[7], number = (HYPRE_BigInt)cell;
        HYPRE_Int count = 0;
        row_of(system, cell, row);
        for (int entry = 0; entry < 7; ++entry) {
            if (entry > 0 && row[entry] == 0.0) {
                continue;
            }
            HYPRE_BigInt along = entry == 0 ? 0 : (HYPRE_BigInt)strides(system, (entry - 1) / 2);
            columns[count] = number + (entry % 2 == 1 ? -along : along);
            values[count++] = row[entry];
        }
        HYPRE_IJMatrixSetValues(matrix, 1, &count, &number, columns, values);
    }
    HYPRE_IJMatrixAssemble(matrix);
    return matrix;
}

static HYPRE_IJVector vector_of(const System *system, const double *values)
{
    size_t first = first_cell(system), cells = own_cells(system);
    HYPRE_IJVector vector;
    HYPRE_IJVectorCreate(MPI_COMM_WORLD, (HYPRE_BigInt)first, (HYPRE_BigInt)(first + cells) - 1, &vector);
    HYPRE_IJVectorSetObjectType(vector, HYPRE_PARCSR);
    HYPRE_IJVectorInitialize(vector);
    for (size_t cell = first; cell < first + cells; ++cell) {
        HYPRE_BigInt number = (HYPRE_BigInt)cell;
        double value = values == NULL ? 0.0 : values[cell];
        HYPRE_IJVectorSetValues(vector, 1, &number, &value);
    }
    HYPRE_IJVectorAssemble(vector);
    return vector;
}

/* Conjugate gradients with BoomerAMG, with the settings that its manual gives for three dimensions. */
static Result solve_with_amg(const System *system, double tolerance)
{
    HYPRE_IJMatrix matrix = matrix_of(system);
    HYPRE_IJVector right = vector_of(system, system->right), solution = vector_of(system, NULL);
    HYPRE_ParCSRMatrix a;
    HYPRE_ParVector b, x;
    HYPRE_IJMatrixGetObject(matrix, (void **)&a);
    HYPRE_IJVectorGetObject(right, (void **)&b);
    HYPRE_IJVectorGetObject(solution, (void **)&x);

    HYPRE_Solver gradients, cycle;
    HYPRE_ParCSRPCGCreate(MPI_COMM_WORLD, &gradients);
    HYPRE_PCGSetTol(gradients, tolerance);
    HYPRE_PCGSetMaxIter(gradients, MOST_ITERATIONS);
    HYPRE_PCGSetTwoNorm(gradients, 1);
    HYPRE_BoomerAMGCreate(&cycle);
    HYPRE_BoomerAMGSetMaxIter(cycle, 1);
    HYPRE_BoomerAMGSetTol(cycle, 0.0);
    HYPRE_BoomerAMGSetCoarsenType(cycle, 10);   /* HMIS */
    HYPRE_BoomerAMGSetInterpType(cycle, 6);     /* extended + i */
    HYPRE_BoomerAMGSetPMaxElmts(cycle, 4);
    HYPRE_BoomerAMGSetStrongThreshold(cycle, 0.5);
    HYPRE_BoomerAMGSetAggNumLevels(cycle, 1);
    HYPRE_BoomerAMGSetRelaxType(cycle, 8);      /* symmetric Gauss-Seidel */
    HYPRE_BoomerAMGSetPrintLevel(cycle, 0);
    HYPRE_PCGSetPrecond(gradients, (HYPRE_PtrToSolverFcn)HYPRE_BoomerAMGSolve,
                        (HYPRE_PtrToSolverFcn)HYPRE_BoomerAMGSetup, cycle);
    Result result;
    double start = worked();
    HYPRE_ParCSRPCGSetup(gradients, a, b, x);
    result.setup = worked() - start;
    start = worked();
    HYPRE_ParCSRPCGSolve(gradients, a, b, x);
    result.solve = worked() - start;
    HYPRE_PCGGetNumIterations(gradients, &result.iterations);
    HYPRE_PCGGetFinalRelativeResidualNorm(gradients, &result.residual);
    HYPRE_BoomerAMGDestroy(cycle);
    HYPRE_ParCSRPCGDestroy(gradients);
    HYPRE_IJMatrixDestroy(matrix);
    HYPRE_IJVectorDestroy(right);
    HYPRE_IJVectorDestroy(solution);
    return result;
}

/* The shortest times of some repetitions. */
static void print_best(const char *name, Result (*solve)(const System *, double), const System *system,
                       double tolerance)
{
    Result best = solve(system, tolerance);
    for (int repetition = 1; repetition < REPETITIONS; ++repetition) {
        Result result = solve(system, tolerance);
        best.setup = fmin(best.setup, result.setup);
        best.solve = fmin(best.solve, result.solve);
    }
    int rank;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (rank == 0) {
        printf("  %-9s %4d iterations, residual %.1e, set-up %8.4f s, solve %8.4f s\n", name, best.iterations,
               best.residual, best.setup, best.solve);
    }
}

int main(int argc, char **argv)
{
    MPI_Init(&argc, &argv);
    HYPRE_Init();
    if (argc != 3) {
        fail("usage: solve SYSTEM TOLERANCE");
    }
    System system = read_system(argv[1]);
    double tolerance = atof(argv[2]);
    print_best("PFMG", solve_with_pfmg, &system, tolerance);
    print_best("BoomerAMG", solve_with_amg, &system, tolerance);
    HYPRE_Finalize();
    MPI_Finalize();
    return 0;
}
