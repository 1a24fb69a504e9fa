/* Fitting poses to walls. fit_twin.py does the same in NumPy, sums in the same order, so with the same roundings. */
#include "fit/fit.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "cast/cast.h"

const double LEAST_SPREAD_CELLS = 0.1, UNKNOWN_CELLS = 256.0, UNKNOWN_RAD = 3.141592653589793;

#define ROUNDS_MAX 32
#define NARROWING 0.7
#define CLOSE 1e-4
#define PRIOR 0.1

/* Where the heads lie at one pose. */
typedef struct {
    double cost, weight, squares, normal[3][3], gradient[3];
} found;

/* Distance and slopes at a point given from the centre of cell (0, 0); outside it is far, and level. */
static inline double interpolated(const fit_job *job, double x, double y, double *slope_x, double *slope_y)
{
    if (!(x >= 0.0 && y >= 0.0 && x < job->cols - 1 && y < job->rows - 1)) {
        *slope_x = *slope_y = 0.0;
        return job->distances[FAR_CODE + 128];
    }
    const int32_t col = (int32_t)x, row = (int32_t)y;
    const double a = x - col, b = y - row, *distances = job->distances + 128;
    const int8_t *code = job->codes + (size_t)row * (size_t)job->cols + (size_t)col;
    const double corner = distances[code[0]], across = distances[code[1]] - corner;
    const double above = distances[code[job->cols]], opposite = distances[code[job->cols + 1]] - above;
    const double low = corner + a * across, high = above + a * opposite;
    *slope_y = high - low;
    *slope_x = across + b * (opposite - across);
    return low + b * *slope_y;
}

/* Add up the normal equations at a pose; `beyond` and `errors` may be NULL. */
static inline found look(const fit_job *job, const double *pose, double width, double *beyond, double *errors)
{
    found f = {0};
    const double turned_cos = cos(pose[2]), turned_sin = sin(pose[2]);
    for (int32_t i = 0; i < job->head_count; i++) {
        const double *head = job->heads + 2 * (size_t)i;
        const double to_x = turned_cos * head[0] - turned_sin * head[1];
        const double to_y = turned_sin * head[0] + turned_cos * head[1];
        double slope[3];
        const double distance = interpolated(job, pose[0] + to_x - 0.5, pose[1] + to_y - 0.5, slope, slope + 1);
        slope[2] = to_x * slope[1] - to_y * slope[0];
        const double ratio = distance / width, rest = 1.0 - ratio * ratio, left = rest > 0.0 ? rest : 0.0;
        const double weight = left * left;
        f.cost += 1.0 - weight * left;
        f.weight += weight;
        f.squares += weight * distance * distance;
        for (int row = 0; row < 3; row++) {
            const double weighted = weight * slope[row];
            f.gradient[row] += weighted * distance;
            for (int col = row; col < 3; col++)
                f.normal[row][col] += weighted * slope[col];
        }
        if (beyond) {
            beyond[i] = to_x * slope[0] + to_y * slope[1] < 0.0 ? -distance : distance;
            errors[i] = weight * beyond[i];
        }
    }
    f.normal[1][0] = f.normal[0][1];
    f.normal[2][0] = f.normal[0][2];
    f.normal[2][1] = f.normal[1][2];
    return f;
}

/* Solve a positive definite system of up to three unknowns, by elimination. */
static void solve(double matrix[3][3], double *right, int size)
{
    for (int pivot = 0; pivot < size; pivot++)
        for (int row = pivot + 1; row < size; row++) {
            const double factor = matrix[row][pivot] / matrix[pivot][pivot];
            for (int col = pivot; col < size; col++)
                matrix[row][col] -= factor * matrix[pivot][col];
            right[row] -= factor * right[pivot];
        }
    for (int row = size - 1; row >= 0; row--) {
        for (int col = row + 1; col < size; col++)
            right[row] -= matrix[row][col] * right[col];
        right[row] /= matrix[row][row];
    }
}

/* Newton's step; the unknown that would leave its bounds by most stops there, and the others go again. */
static void bounded_step(double normal[3][3], const double *gradient, const double *low, const double *high,
                         double *step)
{
    int is_free[3] = {1, 1, 1}, left = 3;
    step[0] = step[1] = step[2] = 0.0;
    while (left) {
        double matrix[3][3], right[3], most = -INFINITY;
        int unknowns[3], size = 0, worst = 0;
        for (int i = 0; i < 3; i++)
            if (is_free[i])
                unknowns[size++] = i;
        for (int row = 0; row < size; row++) {
            double stopped = 0.0;
            for (int j = 0; j < 3; j++)
                if (!is_free[j])
                    stopped += normal[unknowns[row]][j] * step[j];
            right[row] = -gradient[unknowns[row]] - stopped;
            for (int col = 0; col < size; col++)
                matrix[row][col] = normal[unknowns[row]][unknowns[col]];
        }
        solve(matrix, right, size);
        for (int i = 0; i < size; i++) {
            const int u = unknowns[i];
            const double below = low[u] - right[i], above = right[i] - high[u], room = high[u] - low[u];
            const double over = (below > above ? below : above) / (room > 1e-12 ? room : 1e-12);
            if (over > most) {
                most = over;
                worst = i;
            }
        }
        if (most <= 0.0) {
            for (int i = 0; i < size; i++)
                step[unknowns[i]] = right[i];
            return;
        }
        const int u = unknowns[worst];
        step[u] = right[worst] < low[u] ? low[u] : high[u];
        is_free[u] = 0;
        left--;
    }
}

static inline double within(double value, double low, double high)
{
    const double raised = value > low ? value : low;
    return raised < high ? raised : high;
}

static void fit(const fit_job *job, const double *box, double *best)
{
    const double *start = box, *low = box + 3, *high = box + 6;
    double belief[3], at[3], step[3] = {0.0, 0.0, 0.0}, least = INFINITY, width = REACH_CELLS;
    for (int i = 0; i < 3; i++) {
        const double half = (high[i] - low[i]) / 2, room = half > 1e-9 ? half : 1e-9;
        belief[i] = PRIOR / (room * room);
        at[i] = best[i] = within(start[i], low[i], high[i]);
    }
    for (int round = 0; round < ROUNDS_MAX; round++) {
        found f = look(job, at, width, NULL, NULL);
        double moved[3], believed = 0.0, farthest = 0.0;
        for (int i = 0; i < 3; i++) {
            moved[i] = at[i] - start[i];
            believed += belief[i] * moved[i] * moved[i];
        }
        const double cost = f.cost + 3.0 * believed / (width * width);
        if (cost < least) {
            double down[3], up[3];
            least = cost;
            for (int i = 0; i < 3; i++) {
                best[i] = at[i];
                f.normal[i][i] += belief[i];
                f.gradient[i] += belief[i] * moved[i];
                down[i] = low[i] - best[i];
                up[i] = high[i] - best[i];
            }
            bounded_step(f.normal, f.gradient, down, up, step);
        } else {
            for (int i = 0; i < 3; i++)
                step[i] /= 4.0;
        }
        for (int i = 0; i < 3; i++)
            farthest = fabs(step[i]) > farthest ? fabs(step[i]) : farthest;
        if (width > job->outlier_cells) {
            width = width * NARROWING > job->outlier_cells ? width * NARROWING : job->outlier_cells;
            least = INFINITY;
        } else if (farthest < CLOSE) {
            break;
        }
        for (int i = 0; i < 3; i++)
            at[i] = within(best[i] + step[i], low[i], high[i]);
    }
}

/* How much neighbours' errors add up, from their correlations over some lags, nearer ones counting more. */
static double together(const double *errors, int32_t count)
{
    double own = 0.0, lagged[LAGS] = {0.0}, factor = 1.0;
    for (int32_t i = 0; i < count; i++)
        own += errors[i] * errors[i];
    if (!(own > 0.0))
        return 1.0;
    for (int32_t i = 1; i < count; i++)
        for (int32_t lag = 1; lag <= LAGS && lag <= i; lag++)
            lagged[lag - 1] += errors[i] * errors[i - lag];
    for (int32_t lag = 1; lag <= LAGS && lag < count; lag++)
        factor += 2.0 * (1.0 - (double)lag / (LAGS + 1)) * lagged[lag - 1] / own;
    return factor > 1.0 ? factor : 1.0;
}

static void judge(const fit_job *job, const found *f, double *quality, double *covariance)
{
    const double heads = f->weight - HEADS_MIN, spread = f->squares / (heads > 1.0 ? heads : 1.0);
    const double least = LEAST_SPREAD_CELLS * LEAST_SPREAD_CELLS;
    quality[0] = f->weight;
    quality[1] = f->weight > 0.0 ? f->squares / f->weight : 0.0;
    quality[2] = together(job->errors, job->head_count);
    const double variance = (spread > least ? spread : least) * quality[2];
    for (int unknown = 0; unknown < 3; unknown++) {
        double known[3][3], column[3] = {0.0, 0.0, 0.0};
        for (int row = 0; row < 3; row++)
            for (int col = 0; col < 3; col++)
                known[row][col] = f->normal[row][col] / variance;
        known[0][0] += 1.0 / (UNKNOWN_CELLS * UNKNOWN_CELLS);
        known[1][1] += 1.0 / (UNKNOWN_CELLS * UNKNOWN_CELLS);
        known[2][2] += 1.0 / (UNKNOWN_RAD * UNKNOWN_RAD);
        column[unknown] = 1.0;
        solve(known, column, 3);
        for (int row = 0; row < 3; row++)
            covariance[3 * row + unknown] = column[row];
    }
}

void fit_poses(const fit_job *job)
{
    for (int32_t number = 0; number < job->box_count; number++) {
        double *pose = job->poses + 3 * (size_t)number;
        fit(job, job->boxes + 9 * (size_t)number, pose);
        const found f =
            look(job, pose, job->outlier_cells, job->beyond + (size_t)number * (size_t)job->head_count, job->errors);
        judge(job, &f, job->quality + 3 * (size_t)number, job->covariances + 9 * (size_t)number);
    }
}

/* Add what one head costs at all poses of one heading. */
static inline void add_head(const scan_job *job, double x, double y)
{
    const int32_t *steps = job->steps, wide = steps[1] - steps[0] + 1, step = job->step_cells;
    const double col = floor(x) + steps[0] * (double)step, row = floor(y) + steps[2] * (double)step;
    const double last_col = floor(x) + steps[1] * (double)step, last_row = floor(y) + steps[3] * (double)step;
    int32_t *totals = job->totals;
    if (col >= 0.0 && row >= 0.0 && last_col < job->cols && last_row < job->rows) {
        const int8_t *codes = job->codes + (size_t)row * (size_t)job->cols + (size_t)col;
        for (int32_t i = steps[2]; i <= steps[3]; i++, codes += (size_t)step * (size_t)job->cols)
            for (int32_t j = 0; j < wide; j++)
                *totals++ += job->costs[codes[j * step] + 128];
        return;
    }
    for (double at_row = row; at_row <= last_row; at_row += step)
        for (double at_col = col; at_col <= last_col; at_col += step) {
            const int32_t inside = at_col >= 0.0 && at_row >= 0.0 && at_col < job->cols && at_row < job->rows;
            *totals++ +=
                inside ? job->costs[job->codes[(size_t)at_row * (size_t)job->cols + (size_t)at_col] + 128] : job->far;
        }
}

void scan_poses(const scan_job *job)
{
    const int32_t *steps = job->steps, count = (steps[1] - steps[0] + 1) * (steps[3] - steps[2] + 1);
    for (int32_t turn = steps[4]; turn <= steps[5]; turn++) {
        const double heading = job->start[2] + turn * job->step_rad, turned_cos = cos(heading),
                     turned_sin = sin(heading);
        memset(job->totals, 0, (size_t)count * sizeof *job->totals);
        for (int32_t i = 0; i < job->head_count; i++) {
            const double *head = job->heads + 2 * (size_t)i;
            add_head(job, job->start[0] + (turned_cos * head[0] - turned_sin * head[1]),
                     job->start[1] + (turned_sin * head[0] + turned_cos * head[1]));
        }
        for (int32_t i = 0; i < count; i++)
            if (turn == steps[4] || job->totals[i] < job->least[i]) {
                job->least[i] = job->totals[i];
                job->turns[i] = turn;
            }
    }
}
