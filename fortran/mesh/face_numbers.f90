!> Faces that elements have in common.
module lopin_face_numbers
   use lopin_mesh, only : mesh_type
   use lopin_cells, only : cell_type, cell_id
   implicit none
   private
   public :: number_faces, find_neighbours

contains

   !> The element beyond each face; 0: none, or there is no such face.
   subroutine find_neighbours(mesh, cells, beyond)
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cells(:)             !! cell of each element type
      integer, allocatable, intent(out) :: beyond(:, :)   !! (6, nelement)
      integer, allocatable :: number(:, :), first(:, :)
      integer :: e, f, n

      call number_faces(mesh, cells, number, n)
      allocate (beyond(6, mesh%nelement), first(2, n))
      beyond = 0
      first = 0
      do e = 1, mesh%nelement
         do f = 1, 6
            if (number(f, e) == 0) cycle
            associate (other => first(:, number(f, e)))
               if (other(1) > 0) then
                  beyond(f, e) = other(1)
                  beyond(other(2), other(1)) = e
               end if
               other = [e, f]
            end associate
         end do
      end do
   end subroutine find_neighbours

   !> Number the different faces of all solid elements: equal numbers, equal corners.
   pure subroutine number_faces(mesh, cells, number, n)
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cells(:)
      integer, allocatable, intent(out) :: number(:, :)   !! (6, nelement); 0: no such face
      integer, intent(out) :: n                           !! how many
      integer, allocatable :: first(:), next(:), key(:, :)
      integer :: e, f, t, k, corner(4)

      allocate (number(6, mesh%nelement), first(mesh%nnode))
      allocate (next(6*mesh%nelement), key(4, 6*mesh%nelement))
      number = 0
      first = 0
      n = 0
      do e = 1, mesh%nelement
         t = mesh%etype(e)
         if (cells(t)%sided) cycle
         do f = 1, cells(t)%nface
            corner = sorted_corners(mesh, cells(t), e, f)
            k = first(corner(4))
            do while (k > 0)
               if (all(key(:, k) == corner)) exit
               k = next(k)
            end do
            if (k == 0) then
               n = n + 1
               k = n
               key(:, k) = corner
               next(k) = first(corner(4))
               first(corner(4)) = k
            end if
            number(f, e) = k
         end do
      end do
   end subroutine number_faces

   !> Increasing, zeros first.
   pure function sorted_corners(mesh, cell, e, f) result(corner)
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cell
      integer, intent(in) :: e, f
      integer :: corner(4), i, j, held

      corner = 0
      i = merge(2, merge(3, 4, cell%face_cell(f) <= cell_id%triangle6), &
         & cell%face_cell(f) <= cell_id%line3)
      corner(:i) = mesh%conn(cell%face_node(:i, f), e)
      do i = 2, 4
         held = corner(i)
         do j = i - 1, 1, -1
            if (corner(j) <= held) exit
            corner(j + 1) = corner(j)
         end do
         corner(j + 1) = held
      end do
   end function sorted_corners
end module lopin_face_numbers
