/* A sweep into the occupancy grid: what Python calls. */
#ifndef ROBOTD_INSERT_H
#define ROBOTD_INSERT_H

#include <stdint.h>

typedef struct {
    uint8_t *cells; /* [rows][cols], changed */
    int32_t rows;
    int32_t cols;
    double resolution_m;
    double origin_x_m; /* the corner of cell (0, 0) */
    double origin_y_m;
    double robot_x_m; /* where the robot stood */
    double robot_y_m;
    double robot_sin; /* of its heading */
    double robot_cos;
    const double *readings;  /* [count][5]: bearing, range [m], (x, y) of the beam's start [m], is a miss */
    const double *ahead;     /* [2][count]: sine and cosine of each beam's bearing in the map */
    int32_t count, measured; /* those after the measured ones are misses that change unseen cells alone */
    uint8_t unseen;          /* what such a cell holds */
    const uint8_t *lower;    /* [256] */
    const uint8_t *higher;   /* [256] */
    int32_t all_at_once;     /* each cell once, a hit beats all misses; else one beam after the other */
    double *beams;           /* [count][6], for the kernel's own use */
    int64_t *hits;           /* [count], the same */
    uint8_t *before;         /* [rows][cols], the same */
    int64_t *changed;        /* [1 + min(rows * cols, count * (max(rows, cols) + 3))] */
} insert_job;

/* Lower the cells that beams run through and raise those they end in (occupancy.py), and put the cells whose value
 * changed into `changed`, ascending. Returns how many. */
int64_t insert_sweep(const insert_job *job);

#endif
