!> What the integration points of a solid carry from one mesh to another: elastic strain and volume.
!>
!> The elastic part b of the deformation is all that the laws look at; its logarithm adds up, so
!> that means over volumes keep metals incompressible (mean of ln b: 1e-16, of b: 1e-5).
module lopin_elastic_state
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_input, only : element_input_type
   use lopin_deformation, only : deform
   use lopin_dilatation, only : dilatation_count
   use lopin_material_point, only : point_type
   use lopin_hyperelastic, only : log_strain
   use lopin_log_strain, only : log_one_plus
   use lopin_material_memory, only : offset_at
   implicit none
   private
   public :: elastic_state

contains

   !> Of every point, where its memory is that of the displacements: nothing has flowed since.
   pure subroutine elastic_state(element, input, strain, volume, ratio, place, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), intent(out) :: strain(6, element%ngauss)   !! deviator, tensor components; xx yy zz
                                             !! xy xz yz [-]
      real(wp), intent(out) :: volume(element%ngauss)      !! ln J of the elastic part [-]
      real(wp), intent(out) :: ratio(element%ngauss)       !! ln of the present volume over that
                                             !! which the law counts by [-]
      real(wp), intent(out) :: place(element%ngauss)       !! present volume [length^3]
      integer, intent(out) :: bad            !! point turned inside out, or 0
      type(point_type) :: point(element%ngauss)
      real(wp) :: g(element%ndim, element%nnode, element%ngauss)
      real(wp) :: hoop(element%nnode, element%ngauss)
      real(wp) :: phi(element%ngauss, dilatation_count(element))
      integer :: k

      strain = 0.0_wp
      volume = 0.0_wp
      ratio = 0.0_wp
      place = 0.0_wp
      call deform(element, input, point, g, hoop, phi, bad)
      if (bad > 0) return
      do k = 1, element%ngauss
         strain(:, k) = log_strain(point(k)%change, 0.0_wp)
         strain(4:, k) = 0.5_wp*strain(4:, k)
         volume(k) = log_one_plus(point(k)%volume)
         if (size(input%memory, 1) > 0) volume(k) = volume(k) &
            & + input%memory(offset_at(element%nstress), k)
         place(k) = point(k)%weight*(1.0_wp + point(k)%own)
         ratio(k) = log_one_plus(point(k)%own)
      end do
   end subroutine elastic_state
end module lopin_elastic_state
