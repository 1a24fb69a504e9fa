/* Fitting poses to walls: what Python calls. fit_kernel.py describes the arrays. */
#ifndef ROBOTD_FIT_H
#define ROBOTD_FIT_H

#include <stdint.h>

enum {
    HEADS_MIN = 3,
    LAGS = 8
};

extern const double LEAST_SPREAD_CELLS, UNKNOWN_CELLS, UNKNOWN_RAD;

typedef struct {
    const int8_t *codes; /* [rows][cols] */
    int32_t rows;
    int32_t cols;
    const double *distances; /* [256] */
    const double *heads;     /* [head_count][2] */
    int32_t head_count;
    const double *boxes; /* [box_count][9] */
    int32_t box_count;
    double outlier_cells;
    double *poses;       /* [box_count][3] */
    double *covariances; /* [box_count][9] */
    double *quality;     /* [box_count][3] */
    double *beyond;      /* [box_count][head_count] */
    double *errors;      /* [head_count], for the kernel's own use */
} fit_job;

void fit_poses(const fit_job *job);

typedef struct {
    const int8_t *codes; /* [rows][cols] */
    int32_t rows;
    int32_t cols;
    const int32_t *costs; /* [256], by code + 128 */
    int32_t far;          /* the cost of a head outside the map */
    const double *heads;  /* [head_count][2] */
    int32_t head_count;
    const double *start;  /* [3] */
    const int32_t *steps; /* [6]: first and last number of steps along x, y and heading */
    int32_t step_cells;
    double step_rad;
    int32_t *totals; /* [places], for the kernel's own use: one for each step along x and y */
    int32_t *least;  /* [places]: the least cost of all headings, x running fastest */
    int32_t *turns;  /* [places]: the first number of steps of the heading that costs that */
} scan_job;

/* Find the best heading for each place of a lattice: the one at which the heads cost least. */
void scan_poses(const scan_job *job);

#endif
