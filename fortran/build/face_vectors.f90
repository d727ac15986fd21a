!> Areas and normals of element faces, by their corners.
module lopin_face_vectors
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   use lopin_mesh, only : mesh_type
   use lopin_model, only : surface_data_type
   use lopin_vectors, only : cross
   implicit none
   private
   public :: surface_vector, face_vector, centre

contains

   !> Sum of the areas times normals of the faces of a surface: nothing if it is closed.
   pure function surface_vector(mesh, cells, surface) result(vector)
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cells(:)  !! by element type of the mesh
      type(surface_data_type), intent(in) :: surface
      real(wp) :: vector(3)                    !! out of the elements [length^2]
      integer :: i

      vector = 0.0_wp
      do i = 1, size(surface%element)
         associate (e => surface%element(i), cell => cells(mesh%etype(surface%element(i))))
            vector = vector + face_vector(mesh, e, cell%ncorner, &
               & mesh%conn(cell%face_node(:cell%face_nnode(surface%face(i)), surface%face(i)), e))
         end associate
      end do
   end function surface_vector

   !> Area of a face times its normal out of the element; plane: its length [length^2].
   pure function face_vector(mesh, element, ncorner, nodes) result(vector)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element, ncorner
      integer, intent(in) :: nodes(:)          !! of the face, corners first
      real(wp) :: vector(3), a(3), b(3), out(3)

      a = place(mesh, nodes(2)) - place(mesh, nodes(1))
      if (mesh%ndim == 2) then
         vector = [a(2), -a(1), 0.0_wp]
      else
         b = place(mesh, nodes(3)) - place(mesh, nodes(1))
         if (any(size(nodes) == [4, 8])) then
            a = b
            b = place(mesh, nodes(4)) - place(mesh, nodes(2))
         end if
         vector = 0.5_wp*cross(a, b)
      end if
      out = place(mesh, nodes(1)) - centre(mesh, mesh%conn(:ncorner, element))
      vector = sign(1.0_wp, dot_product(vector, out))*vector
   end function face_vector

   !> Mean place of nodes.
   pure function centre(mesh, nodes) result(x)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: nodes(:)
      real(wp) :: x(3)                         !! [length]
      integer :: i

      x = 0.0_wp
      do i = 1, size(nodes)
         x = x + place(mesh, nodes(i))/size(nodes)
      end do
   end function centre

   pure function place(mesh, node) result(x)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node
      real(wp) :: x(3)

      x = 0.0_wp
      x(:mesh%ndim) = mesh%x(:, node)
   end function place
end module lopin_face_vectors
