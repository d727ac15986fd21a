!> Assembly of small-strain solids: the stiffness of a whole mesh.
module lopin_assemble_linear
   use lopin_kinds, only : wp, ik
   use lopin_error, only : error_type, error_code, raise
   use lopin_mesh, only : mesh_type, place_of_element
   use lopin_shared_work, only : shared_work_type, share_out
   use lopin_csc, only : csc_type
   use lopin_element_type, only : element_type
   use lopin_simplex_patches, only : patch_element
   use lopin_solid_small, only : stiffness, strain_matrices
   use lopin_solids, only : solids_type, group_type, unit_nodes, add_slots
   use lopin_assemble_springs, only : add_springs
   implicit none
   private
   public :: assemble_stiffness

   !> Elements of one colour touch different nodes.
   type, extends(shared_work_type) :: stiffness_work_type
      type(solids_type), pointer :: solids => null()
      type(mesh_type), pointer :: mesh => null()
      real(wp), pointer :: value(:) => null()
      integer, allocatable :: folded(:)    !! (nelement) as of add_unit
   contains
      procedure :: do_part => add_one_unit
   end type stiffness_work_type

contains

   !> Stiffness of all solid elements into a matrix made by `new_solids`; its values are replaced.
   subroutine assemble_stiffness(self, mesh, matrix, error)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in), target :: mesh
      type(csc_type), intent(inout), target :: matrix
      type(error_type), allocatable, intent(out) :: error
      type(stiffness_work_type) :: work
      integer :: folded
      real(wp), allocatable :: nothing(:)
      real(wp) :: unused

      matrix%value = 0.0_wp
      work%solids => self
      work%mesh => mesh
      work%value => matrix%value
      allocate (work%folded(size(self%order)), source=huge(1))
      call share_out(work, self%colour_start, self%last_is_serial)
      folded = minval(work%folded)
      if (folded < huge(1)) call report_folded(self, mesh, folded, error)
      if (.not. allocated(self%spring)) return
      allocate (nothing(self%n), source=0.0_wp)
      unused = 0.0_wp
      call add_springs(self, mesh, spread(0.0_wp, 1, self%n), .false., nothing, unused, &
         & matrix%value)
   end subroutine assemble_stiffness

   subroutine add_one_unit(self, k)
      class(stiffness_work_type), intent(inout) :: self
      integer, intent(in) :: k             !! place in the order of elements

      call add_unit(self%solids, self%mesh, self%solids%order(k), self%value, self%folded(k))
   end subroutine add_one_unit

   subroutine add_unit(self, mesh, e, value, folded)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      real(wp), intent(inout) :: value(:)
      integer, intent(inout) :: folded      !! least element with det J <= 0, or first of its patch
      type(element_type) :: element

      associate (group => self%group(self%which(e)), &
         & slot => self%slot(self%first_slot(e):self%first_slot(e + 1) - 1))
         if (self%patches%of(e) == 0) then
            call add_element(group, group%element, mesh%x(:, mesh%conn(:group%element%nnode, e)), &
               & slot, e, value, folded)
         else
            call patch_element(self%patches, self%patches%of(e), mesh%conn, group%element, element)
            call add_element(group, element, mesh%x(:, unit_nodes(self, mesh, e)), slot, e, value, &
               & folded)
         end if
      end associate
   end subroutine add_unit

   subroutine add_element(group, element, x, slot, e, value, folded)
      type(group_type), intent(in) :: group
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: e
      integer(ik), intent(in) :: slot(:)
      real(wp), intent(inout) :: value(:)
      integer, intent(inout) :: folded
      real(wp) :: ke(element%ndof, element%ndof), smallest
      integer :: point

      call stiffness(element, x, group%thickness, group%d, ke, smallest, point)
      if (smallest <= 0.0_wp) then
         folded = min(folded, e)
         return
      end if
      call add_slots(slot, ke, value)
   end subroutine add_element

   !> One error that names the first folded element, its worst point and how many others there are.
   subroutine report_folded(self, mesh, first, error)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: first      !! none before it is folded
      type(error_type), allocatable, intent(out) :: error
      character(len=160) :: text
      character(len=:), allocatable :: help
      real(wp) :: smallest, worst
      integer :: e, point, at, number, named

      number = 0
      worst = 0.0_wp
      at = 1
      named = first
      do e = first, mesh%nelement
         if (self%which(e) == 0) cycle
         call jacobian_of(self%group(self%which(e)), mesh%x, mesh%conn(:, e), smallest, point)
         if (smallest > 0.0_wp) cycle
         number = number + 1
         if (number > 1) cycle
         named = e
         worst = smallest
         at = point
      end do
      write (text, '(a,i0,3a,i0,a,es10.3)') 'element ', mesh%element_label(named), ' (', &
         & trim(self%group(self%which(named))%element%word), ') is folded: at integration point ', &
         & at, ' the Jacobian is ', worst
      help = 'list its nodes in the order of the element: counter-clockwise in the plane, nodes' &
         & //' of the first face before those of the second in space'
      if (number > 1) then
         write (text(len_trim(text) + 1:), '(a,i0)') '; folded elements in all: ', number
      end if
      call raise(error, error_code%deck, 'E0302', trim(text), place_of_element(mesh, named), &
         & help=help)
   end subroutine report_folded

   subroutine jacobian_of(group, x, conn, smallest, point)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: conn(:)
      real(wp), intent(out) :: smallest
      integer, intent(out) :: point
      real(wp) :: b(group%element%ndof, group%element%nstress, group%element%ngauss)
      real(wp) :: volume(group%element%ngauss)
      call strain_matrices(group%element, x(:, conn(:group%element%nnode)), group%thickness, b, &
         & volume, smallest, point)
   end subroutine jacobian_of
end module lopin_assemble_linear
