!> Surface-to-surface rows of the linear paths that press where the bodies do not touch.
!>
!> A row is the mean of its gaps by a dual function, which is negative over a part of its facets
!> (lopin_mortar_least). The nonlinear path bounds it by the least of these gaps. On the linear
!> paths rows are fixed: what they press is looked at on the present shape.
module lopin_across_gaps
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_model, only : model_type
   use lopin_mortar_pairs, only : coupled_pair_type, couple_pair, is_mortar
   use lopin_contact_points, only : gaps_as_meshed
   use lopin_initial_gaps, only : is_moved
   use lopin_repeated_messages, only : warn_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: across_type, find_across_gaps, report_across_gaps

   !> Of a facet: smaller gaps are inexact geometry; share of the force that matters.
   real(wp), parameter :: inexact = 1.0e-4_wp, matters = 0.01_wp

   type :: across_type
      integer :: pair = 0                      !! that presses across a gap; 0: none
      integer :: node = 0                      !! where it presses most so
      real(wp) :: gap = 0.0_wp                 !! least over its facets [length]
      real(wp) :: share = 0.0_wp               !! of the normal force of the pair [-]
   end type across_type

contains

   !> The pair with the largest share of force across gaps in the trial.
   subroutine find_across_gaps(self, scene, model)
      type(across_type), intent(out) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(across_type) :: found
      integer :: pair

      if (.not. any(scene%points%above(:scene%points%n) > 0.0_wp)) return
      do pair = 1, size(model%pair)
         if (.not. is_mortar(model, model%pair(pair))) cycle
         if (.not. gaps_as_meshed(model, model%pair(pair))) cycle
         associate (of => scene%points%first(pair), to => scene%points%first(pair + 1) - 1)
            if (.not. any(scene%points%above(of:to) > 0.0_wp)) cycle
         end associate
         call measure_across(found, scene, model, pair)
         if (found%share > max(self%share, matters)) self = found
      end do
   end subroutine find_across_gaps

   subroutine measure_across(self, scene, model, pair)
      type(across_type), intent(out) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(coupled_pair_type) :: coupled
      type(cell_type), allocatable :: cells(:)
      type(error_type), allocatable :: error
      real(wp) :: force(scene%points%n), x(size(model%mesh%x, 1), size(model%mesh%x, 2)), gap, &
         & most
      integer :: row, j, k, i

      force = 0.0_wp
      do row = scene%rows%group_first(pair), scene%rows%group_first(pair + 1) - 1
         if (scene%answer%active(row)) force(scene%rows%point(row)) = abs(scene%answer%force(row))
      end do
      if (.not. any(force > 0.0_wp)) return
      x = model%mesh%x
      do i = 1, model%mesh%nnode
         do k = 1, model%mesh%ndim
            if (scene%dofs%id(k, i) > 0) x(k, i) = x(k, i) &
               & + scene%trial%motion%u(scene%dofs%id(k, i))
         end do
      end do
      call cells_of_words(model%element_word, cells)
      call couple_pair(coupled, model, cells, pair, .false., error, x)
      if (allocated(error)) return
      most = 0.0_wp
      do j = 1, coupled%rows%n
         i = scene%points%first(pair) + coupled%rows%place(j) - 1
         if (is_moved(scene%initial%shift(i), scene%points%size(i))) cycle
         gap = coupled%rows%gap(j) + coupled%rows%above(j)
         if (.not. coupled%rows%above(j) > 0.0_wp &
            & .or. .not. gap > inexact*scene%points%size(i)) cycle
         self%share = self%share + force(i)/sum(force)
         if (.not. force(i) > most) cycle
         most = force(i)
         self%pair = pair
         self%gap = gap
         self%node = scene%points%node(i)
      end do
   end subroutine measure_across

   subroutine report_across_gaps(self, scene, model)
      type(across_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      if (self%pair == 0) return
      associate (p => model%pair(self%pair))
         call warn_once(scene%log, 'W0342', model%surface(p%slave)%name//' and '// &
            & model%surface(p%master)%name//' press each other where they do not touch: node '// &
            & to_text(model%mesh%node_label(self%node))//' across a gap of '// &
            & to_text(self%gap, 3)//', nodes like it with '// &
            & to_text(100.0_wp*self%share, 2)//' % of the force', p%at, &
            & help='slave facets that are fine beside the curve of the master, the convex side '// &
            & 'as the slave, or NLGEOM (*LOPIN, PATH=FINITE), which finds the least gap')
      end associate
   end subroutine report_across_gaps
end module lopin_across_gaps
