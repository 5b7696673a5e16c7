// itk_read.cpp: what ITK makes of files that smr writes.
// Usage: itk_read field FIELD FROM.csv TO.csv MM   moves points label,x,y,z; ends with 1 where one is farther off than MM
//        itk_read mesh FILE.vtk                    the surface as OBJ
//        itk_read labels FILE                      "x y z label" of each voxel that has a label
// SPDX-License-Identifier: MIT
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <itkDisplacementFieldTransform.h>
#include <itkImageFileReader.h>
#include <itkImageRegionConstIteratorWithIndex.h>
#include <itkMesh.h>
#include <itkMeshFileReader.h>

using Transform = itk::DisplacementFieldTransform<double, 3>;
using Field = Transform::DisplacementFieldType;
using Labels = itk::Image<unsigned int, 3>;
using Mesh = itk::Mesh<float, 3>;
using Point = itk::Point<double, 3>;

static std::vector<Point> read_points(const char *path)
{
    std::vector<Point> points;
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        Point p;
        const size_t at = line.find(',', line.rfind('"') == std::string::npos ? 0 : line.rfind('"'));
        if (std::sscanf(line.c_str() + at, ",%lf,%lf,%lf", &p[0], &p[1], &p[2]) == 3)
            points.push_back(p);
    }
    return points;
}

static int move_points(char **argv)
{
    const std::vector<Point> from = read_points(argv[1]), to = read_points(argv[2]);
    const double most = std::stod(argv[3]);
    auto transform = Transform::New();
    double worst = 0.0;
    transform->SetDisplacementField(itk::ReadImage<Field>(argv[0]));
    for (size_t i = 0; i < from.size() && from.size() == to.size(); i++)
        worst = std::max(worst, transform->TransformPoint(from[i]).EuclideanDistanceTo(to[i]));
    std::cout << from.size() << " points, worst " << worst << " mm" << std::endl;
    return !(from.size() > 1 && from.size() == to.size() && worst <= most);
}

static int print_mesh(const char *path)
{
    auto reader = itk::MeshFileReader<Mesh>::New();
    reader->SetFileName(path);
    reader->Update();
    Mesh *const mesh = reader->GetOutput();
    for (unsigned long i = 0; i < mesh->GetNumberOfPoints(); i++) {
        const Mesh::PointType p = mesh->GetPoint(i);
        std::printf("v %.9g %.9g %.9g\n", p[0], p[1], p[2]);
    }
    for (auto cell = mesh->GetCells()->Begin(); cell != mesh->GetCells()->End(); ++cell) {
        std::printf("f");
        for (auto id = cell.Value()->PointIdsBegin(); id != cell.Value()->PointIdsEnd(); ++id)
            std::printf(" %lu", (unsigned long)*id + 1);
        std::printf("\n");
    }
    return mesh->GetNumberOfCells() == 0;
}

static int print_labels(const char *path)
{
    const Labels::Pointer image = itk::ReadImage<Labels>(path);
    itk::ImageRegionConstIteratorWithIndex<Labels> at(image, image->GetLargestPossibleRegion());
    Point p;
    for (; !at.IsAtEnd(); ++at)
        if (at.Get() != 0) {
            image->TransformIndexToPhysicalPoint(at.GetIndex(), p);
            std::printf("%.3f %.3f %.3f %u\n", p[0] + 0.0, p[1] + 0.0, p[2] + 0.0, at.Get());
        }
    return 0;
}

int main(int argc, char **argv)
try {
    if (argc == 6 && std::strcmp(argv[1], "field") == 0)
        return move_points(argv + 2);
    if (argc == 3 && std::strcmp(argv[1], "mesh") == 0)
        return print_mesh(argv[2]);
    if (argc == 3 && std::strcmp(argv[1], "labels") == 0)
        return print_labels(argv[2]);
    return 2;
} catch (const itk::ExceptionObject &e) {
    std::cout << e << std::endl;
    return 2;
}
