/* Fitting poses to walls: what Python calls. fitting.py describes the arrays. */

typedef struct {
    const int8_t *codes;       /* [rows][cols] */
    int32_t rows;
    int32_t cols;
    const double *distances;   /* [256] */
    const double *heads;       /* [head_count][2] */
    int32_t head_count;
    const double *boxes;       /* [box_count][9] */
    int32_t box_count;
    double outlier_cells;
    double *poses;             /* [box_count][3] */
    double *covariances;       /* [box_count][9] */
    double *quality;           /* [box_count][3] */
    double *beyond;            /* [box_count][head_count] */
    double *errors;            /* [head_count], for the kernel's own use */
} fit_job;

void fit_poses(const fit_job *job);
