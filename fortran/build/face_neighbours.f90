!> The element on the other side of a face, by the corners that they share.
module lopin_face_neighbours
   use lopin_cells, only : cell_type, cell_id
   use lopin_model, only : model_type
   use lopin_build_scene, only : scene_type
   implicit none
   private
   public :: neighbours_type, find_neighbours, across

   !> Which elements have each node as a corner, for the neighbour across a face.
   type :: neighbours_type
      integer, allocatable :: start(:), element(:)
      logical :: within = .false.              !! faces between elements may be taken too
   end type neighbours_type

contains

   subroutine find_neighbours(self, model, scene)
      type(neighbours_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      integer, allocatable :: filled(:)
      integer :: e, i, n

      allocate (self%start(model%mesh%nnode + 1), source=0)
      do e = 1, model%mesh%nelement
         if (scene%etype(model%mesh%etype(e))%cell%sided) cycle
         n = scene%etype(model%mesh%etype(e))%cell%ncorner
         do i = 1, n
            associate (node => model%mesh%conn(i, e))
               if (node > 0) self%start(node + 1) = self%start(node + 1) + 1
            end associate
         end do
      end do
      self%start(1) = 1
      do i = 2, size(self%start)
         self%start(i) = self%start(i) + self%start(i - 1)
      end do
      filled = self%start
      allocate (self%element(self%start(size(self%start)) - 1))
      do e = 1, model%mesh%nelement
         if (scene%etype(model%mesh%etype(e))%cell%sided) cycle
         n = scene%etype(model%mesh%etype(e))%cell%ncorner
         do i = 1, n
            associate (node => model%mesh%conn(i, e))
               if (node == 0) cycle
               self%element(filled(node)) = e
               filled(node) = filled(node) + 1
            end associate
         end do
      end do
   end subroutine find_neighbours

   !> The other element that has the corners of a face; 0 on the boundary.
   pure integer function across(model, cell, neighbours, e, f) result(other)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell
      type(neighbours_type), intent(in) :: neighbours
      integer, intent(in) :: e, f
      integer :: corner(4), n, k, i
      logical :: all_there

      n = cell%face_nnode(f)
      if (cell%quadratic) n = merge(2, n/2, cell%face_cell(f) == cell_id%line3)
      corner(:n) = model%mesh%conn(cell%face_node(:n, f), e)
      do k = neighbours%start(corner(1)), neighbours%start(corner(1) + 1) - 1
         other = neighbours%element(k)
         if (other == e) cycle
         all_there = .true.
         do i = 2, n
            all_there = all_there .and. any(model%mesh%conn(:8, other) == corner(i))
         end do
         if (all_there) return
      end do
      other = 0
   end function across
end module lopin_face_neighbours
