/* mrml_scene.c: writes a scene of 3D Slicer, in the words of its version 5.10: a file's coordinates are what its own
 * SPACE says, else what coordinateSystem says; nothing is RAS by default in this version's scenes.
 * SPDX-License-Identifier: MIT */
#include "scene/mrml_scene.h"
#include <stdlib.h>
#include "carry/carry_volume.h"
#include "files/file_names.h"

#define FIELD_ID "vtkMRMLGridTransformNode1"

/* A file's name, as the scene's directory sees it; as it was given where that directory is gone. */
static void put_file(host_scene *scene, const char *file)
{
    char *const path = host_relative_path(scene->path, file);
    host_xml_file(scene->out, "fileName", path != NULL ? path : file);
    free(path);
}

static void put_color(host_scene *scene, const char *key, const float color[3])
{
    host_buffer_print(scene->out, " %s=\"%.3g %.3g %.3g\"", key, (double)color[0], (double)color[1], (double)color[2]);
}

void host_scene_begin(host_scene *to)
{
    host_buffer_print(to->out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<MRML version=\"Slicer 5.10.0 34000\">\n");
}

void host_scene_field(host_scene *scene, const char *name, const char *file)
{
    host_buffer_print(scene->out, "<TransformStorage id=\"vtkMRMLTransformStorageNode1\"");
    put_file(scene, file);
    host_buffer_print(scene->out, "/>\n<GridTransform id=\"" FIELD_ID "\"");
    host_xml_attribute(scene->out, "name", name);
    host_buffer_print(scene->out, " storageNodeRef=\"vtkMRMLTransformStorageNode1\"/>\n");
    scene->has_field = 1;
}

void host_scene_volume(host_scene *scene, const char *name, const char *file, int moved)
{
    const uint32_t i = ++scene->n_volumes;
    host_buffer_print(scene->out, "<VolumeArchetypeStorage id=\"vtkMRMLVolumeArchetypeStorageNode%u\"", i);
    put_file(scene, file);
    host_buffer_print(scene->out,
                      "/>\n<VolumeDisplay id=\"vtkMRMLScalarVolumeDisplayNode%u\" "
                      "colorNodeID=\"vtkMRMLColorTableNodeGrey\" autoWindowLevel=\"1\"/>\n"
                      "<Volume id=\"vtkMRMLScalarVolumeNode%u\"",
                      i, i);
    host_xml_attribute(scene->out, "name", name);
    host_buffer_print(scene->out,
                      " storageNodeRef=\"vtkMRMLVolumeArchetypeStorageNode%u\" "
                      "displayNodeRef=\"vtkMRMLScalarVolumeDisplayNode%u\"%s/>\n",
                      i, i, moved && scene->has_field ? " transformNodeRef=\"" FIELD_ID "\"" : "");
}

void host_scene_model_add(host_scene *scene, const host_scene_model *model)
{
    const uint32_t i = ++scene->n_models;
    host_buffer_print(scene->out, "<ModelStorage id=\"vtkMRMLModelStorageNode%u\"", i);
    put_file(scene, model->file);
    host_buffer_print(scene->out, " coordinateSystem=\"LPS\"/>\n<ModelDisplay id=\"vtkMRMLModelDisplayNode%u\"", i);
    put_color(scene, "color", model->color);
    /* the last but one is what Slicer called visibility2D before 2019 */
    host_buffer_print(scene->out,
                      " opacity=\"%.3g\" visibility=\"true\" visibility2D=\"true\" "
                      "sliceIntersectionVisibility=\"true\" sliceIntersectionThickness=\"2\"",
                      (double)model->opacity);
    if (model->scalars != NULL) {
        host_buffer_print(scene->out, " scalarVisibility=\"false\"");
        host_xml_attribute(scene->out, "activeScalarName", model->scalars);
        host_buffer_print(scene->out,
                          " scalarRangeFlag=\"UseManual\" scalarRange=\"0 %.3g\" "
                          "colorNodeID=\"vtkMRMLColorTableNodeFileViridis.txt\"",
                          model->most);
    }
    host_buffer_print(scene->out, "/>\n<Model id=\"vtkMRMLModelNode%u\"", i);
    host_xml_attribute(scene->out, "name", model->name);
    host_buffer_print(scene->out,
                      " storageNodeRef=\"vtkMRMLModelStorageNode%u\" displayNodeRef=\"vtkMRMLModelDisplayNode%u\"/>\n",
                      i, i);
}

void host_scene_points(host_scene *scene, const char *name, const char *file, const float color[3])
{
    const uint32_t i = ++scene->n_points;
    host_buffer_print(scene->out, "<MarkupsJsonStorage id=\"vtkMRMLMarkupsJsonStorageNode%u\"", i);
    put_file(scene, file);
    host_buffer_print(scene->out, "/>\n<MarkupsFiducialDisplay id=\"vtkMRMLMarkupsFiducialDisplayNode%u\"", i);
    put_color(scene, "color", color);
    put_color(scene, "selectedColor", color);
    host_buffer_print(scene->out, " glyphScale=\"2\"/>\n<MarkupsFiducial id=\"vtkMRMLMarkupsFiducialNode%u\"", i);
    host_xml_attribute(scene->out, "name", name);
    host_buffer_print(scene->out,
                      " storageNodeRef=\"vtkMRMLMarkupsJsonStorageNode%u\" "
                      "displayNodeRef=\"vtkMRMLMarkupsFiducialDisplayNode%u\"/>\n",
                      i, i);
}

void host_scene_end(host_scene *scene)
{
    static const char *const views[] = {"Red", "Green", "Yellow"};
    for (size_t i = 0; scene->n_volumes > 0 && i < sizeof views / sizeof views[0]; i++)
        host_buffer_print(scene->out,
                          "<SliceComposite id=\"vtkMRMLSliceCompositeNode%s\" name=\"SliceComposite\" "
                          "singletonTag=\"%s\" layoutName=\"%s\" backgroundVolumeID=\"vtkMRMLScalarVolumeNode1\"/>\n",
                          views[i], views[i], views[i]);
    host_buffer_print(scene->out, "</MRML>\n");
}

#define MARGIN_MM 20.0f
#define SPACING_MM 4.0f
#define COARSER 1.05f

static size_t voxels(const host_volume *grid) { return (size_t)grid->size[0] * grid->size[1] * grid->size[2]; }

static int choose_grid(const host_carried *c, host_volume *grid, host_error *error)
{
    float low[3] = {0}, high[3] = {0}, s = SPACING_MM;
    int fits = 0;
    host_carried_box(c, 1, low, high);
    for (; !fits && s < SMR_COORD_MAX; s *= COARSER) {
        const float spacing[3] = {s, s, s};
        fits = host_volume_around(low, high, MARGIN_MM, spacing, grid) == 0 && voxels(grid) <= HOST_SCENE_VOXELS;
    }
    return fits ? 0 : host_fail(error, "field", "a result of less than %.0f mm", (double)SMR_COORD_MAX);
}

/* Every second voxel of the grid, and one beyond its end where it has an even number. */
static host_volume lattice_of(const host_volume *grid)
{
    host_volume lattice = *grid;
    for (uint32_t k = 0; k < 3; k++) {
        lattice.size[k] = grid->size[k] / 2u + 1u;
        lattice.spacing[k] = 2.0f * grid->spacing[k];
    }
    return lattice;
}

/* The value of a voxel: the mean of the points of the lattice that it lies between, 1, 2, 4 or 8. */
static void halve(const host_volume *lattice, const float *from, const uint32_t at[3], float to[3])
{
    for (uint32_t k = 0; k < 3; k++)
        to[k] = 0.0f;
    for (uint32_t corner = 0; corner < 8u; corner++) {
        size_t i = 0;
        for (uint32_t k = 3; k-- > 0u;)
            i = i * lattice->size[k] + at[k] / 2u + ((corner >> k & 1u) & at[k]);
        for (uint32_t k = 0; k < 3; k++)
            to[k] += from[3u * i + k] / 8.0f;
    }
}

static void fill(const host_volume *lattice, const float *from, const host_volume *grid, float *field)
{
    uint32_t at[3];
    for (at[2] = 0; at[2] < grid->size[2]; at[2]++)
        for (at[1] = 0; at[1] < grid->size[1]; at[1]++)
            for (at[0] = 0; at[0] < grid->size[0]; at[0]++, field += 3)
                halve(lattice, from, at, field);
}

int64_t host_scene_field_write(host_carried *c, host_buffer *out, double *share, host_error *error)
{
    host_volume grid, lattice;
    int64_t missed = -1;
    if (choose_grid(c, &grid, error) != 0)
        return -1;
    lattice = lattice_of(&grid);
    float *from = malloc(3u * sizeof *from * voxels(&lattice));
    float *field = malloc(3u * sizeof *field * voxels(&grid));
    if (from == NULL || field == NULL)
        (void)host_fail(error, "field", "free memory for %zu voxels", voxels(&grid));
    else
        missed = host_carried_field(c, &lattice, 1, from, error);
    if (missed >= 0) {
        fill(&lattice, from, &grid, field);
        host_carried_field_fit(c, &grid, 1, field);
        host_carried_field_file(&grid, 1, field, ".nrrd", out);
        *share = (double)missed / (double)voxels(&lattice);
    }
    free(from);
    free(field);
    return missed;
}
