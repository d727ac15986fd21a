!> Integration points as files show them: their order, energy and volume of elements, values at
!> nodes.
module lopin_element_points
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_report, only : frame_type
   use lopin_element_type, only : element_type, new_element_type, element_kind
   use lopin_quadrature, only : calculix_order
   use lopin_solid_small, only : strain_matrices
   use lopin_flow_curve, only : flows
   implicit none
   private
   public :: point_tables_type, new_point_tables, element_measures, nodal_average

   integer, parameter :: max_points = 108

   !> One column for each word of the model's list of element words.
   type :: point_tables_type
      type(element_type), allocatable :: element(:)
      integer, allocatable :: order(:, :)   !! (108, nword) our point of the file's k-th
   end type point_tables_type

contains

   subroutine new_point_tables(self, model)
      type(point_tables_type), intent(out) :: self
      type(model_type), intent(in) :: model
      logical :: found
      integer :: i, k, n

      n = size(model%element_word)
      allocate (self%element(n), self%order(max_points, n))
      do i = 1, n
         call new_element_type(self%element(i), trim(model%element_word(i)), '', found)
         self%order(:, i) = [(k, k=1, max_points)]
         if (allocated(self%element(i)%xi)) then
            self%order(:self%element(i)%ngauss, i) = calculix_order(self%element(i)%xi)
         end if
      end do
   end subroutine new_point_tables

   !> Strain energy and volume of elements; zero for rigid ones. Full circumference if axisymmetric.
   subroutine element_measures(self, model, item, frame, measure)
      type(point_tables_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: item(:)                        !! elements
      type(frame_type), intent(in) :: frame
      real(wp), allocatable, intent(out) :: measure(:, :)   !! (2, nelement)
      real(wp), allocatable :: b(:, :, :), volume(:)
      real(wp) :: smallest, thickness
      integer :: i, e, first, last, worst

      allocate (measure(2, model%mesh%nelement), source=0.0_wp)
      do i = 1, size(item)
         e = item(i)
         if (model%mesh%section(e) == 0) cycle
         thickness = model%section(model%mesh%section(e))%thickness
         associate (element => self%element(model%mesh%etype(e)))
            if (element%ndof == 0) cycle
            if (allocated(b)) deallocate (b, volume)
            allocate (b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss))
            call strain_matrices(element, model%mesh%x(:, model%mesh%conn(:element%nnode, e)), &
               & thickness, &
               & b, volume, smallest, worst)
            measure(2, e) = sum(volume)
            if (.not. (allocated(frame%stress) .and. allocated(frame%strain))) cycle
            first = frame%first_point(e)
            last = first + element%ngauss - 1
            associate (material => model%material(model%section(model%mesh%section(e))%material))
               if (flows(material%flow)) then
                  measure(1, e) = sum(volume*stored(frame%stress(:, first:last), material%young, &
                     & material%poisson))
               else
                  measure(1, e) = 0.5_wp*sum(volume*sum(frame%stress(:, first:last) &
                     & *frame%strain(:, first:last), dim=1))
               end if
            end associate
         end associate
      end do
   end subroutine element_measures

   !> Energy per volume that stresses store: what flow has taken is gone.
   pure function stored(stress, young, poisson) result(density)
      real(wp), intent(in) :: stress(:, :)     !! (6, npoint) [stress]
      real(wp), intent(in) :: young, poisson
      real(wp) :: density(size(stress, 2))
      density = (0.5_wp*(1.0_wp + poisson)*(sum(stress(:3, :)**2, dim=1) &
         & + 2.0_wp*sum(stress(4:, :)**2, dim=1)) &
         & - 0.5_wp*poisson*sum(stress(:3, :), dim=1)**2)/young
   end function stored

   !> Values at integration points extrapolated to the nodes and averaged there.
   subroutine nodal_average(self, model, first_point, values, at_node)
      type(point_tables_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: first_point(:)
      real(wp), intent(in) :: values(:, :)                  !! (ncomponent, npoint)
      real(wp), allocatable, intent(out) :: at_node(:, :)   !! (ncomponent, nnode)
      integer, allocatable :: times(:)
      integer :: e, k, node

      allocate (at_node(size(values, 1), model%mesh%nnode), source=0.0_wp)
      allocate (times(model%mesh%nnode), source=0)
      do e = 1, model%mesh%nelement
         associate (element => self%element(model%mesh%etype(e)))
            if (element%kind == element_kind%rigid) cycle
            do k = 1, element%nnode
               node = model%mesh%conn(k, e)
               times(node) = times(node) + 1
               at_node(:, node) = at_node(:, node) + matmul(values(:, &
                  & first_point(e):first_point(e + 1) - 1), &
                  & element%extrapolation(k, :))
            end do
         end associate
      end do
      do node = 1, model%mesh%nnode
         if (times(node) > 0) at_node(:, node) = at_node(:, node)/real(times(node), wp)
      end do
   end subroutine nodal_average
end module lopin_element_points
