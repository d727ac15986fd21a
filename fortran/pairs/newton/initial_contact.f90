!> Quantities measured once, in the state in which contact is first evaluated: ties, and walls of
!> surfaces in contact with themselves.
module lopin_initial_contact
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_search, only : cost_type
   use lopin_master_surfaces, only : move_masters
   use lopin_nonlinear_samples, only : offset_of
   use lopin_mortar_element, only : update_mortar
   use lopin_contact_detection, only : detect_contact, take_anchor
   implicit none
   private
   public :: measure_initial_contact

contains

   !> Ties and walls as these displacements have them.
   subroutine measure_initial_contact(self, model, u, error)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      type(error_type), allocatable, intent(out) :: error
      type(cost_type) :: cost
      integer :: i, pair

      self%met_at = u
      call move_masters(self%masters, model, self%dofs, self%nonlinear_points_type, u, .true., &
         & cost, error)
      if (allocated(error)) return
      if (.not. any(self%enforcement%tied)) return
      self%tied_at = self%masters%x
      do pair = 1, size(self%mortar)
         if (.not. (self%mortar(pair)%is_on .and. self%mortar(pair)%tied)) cycle
         associate (master => self%masters%of(pair))
            master%surface%outlook = master%surface%disc(4:6, :)
            call update_mortar(self%mortar(pair), self%masters%rules, master%surface, master%tree, &
               & self%tied_at, .true., .false., error)
            if (allocated(error)) return
         end associate
      end do
      do i = 1, self%n
         if (.not. self%enforcement(i)%tied) cycle
         call detect_contact(self, model, i, .true.)
         call take_anchor(self, model, i)
         self%anchor(i)%offset = offset_of(self%masters, self%nonlinear_points_type, i)
      end do
   end subroutine measure_initial_contact
end module lopin_initial_contact
