/* mrml_scene.c: writes a scene of 3D Slicer, in the words of its version 5.10: a file's coordinates are what its own
 * SPACE says, else what coordinateSystem says; nothing is RAS by default in this version's scenes.
 * SPDX-License-Identifier: MIT */
#include "scene/mrml_scene.h"

#include <stdlib.h>

#include "base/xml_text.h"
#include "files/relative_path.h"

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

void host_scene_begin(host_scene *scene)
{
    host_buffer_print(scene->out,
                      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<MRML version=\"Slicer 5.10.0 34000\">\n");
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
    size_t i = 0;
    for (i = 0; scene->n_volumes > 0 && i < sizeof views / sizeof views[0]; i++)
        host_buffer_print(scene->out,
                          "<SliceComposite id=\"vtkMRMLSliceCompositeNode%s\" name=\"SliceComposite\" "
                          "singletonTag=\"%s\" layoutName=\"%s\" "
                          "backgroundVolumeID=\"vtkMRMLScalarVolumeNode1\"/>\n",
                          views[i], views[i], views[i]);
    host_buffer_print(scene->out, "</MRML>\n");
}
